"""Learning to rebuild windows of motion from few numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from torch import Tensor, nn

from analysis.evaluators.autoencoder_network import AutoencoderConfig, AutoencoderNetwork
from analysis.evaluators.examples import Examples

_AT_ONCE: Final = 256


@dataclass(frozen=True, kw_only=True, eq=False)
class ReconstructionTask:
    """Mean absolute error of values and of their changes from frame to frame (Yoon et al. 2020).

    Attributes
    ----------
    config : AutoencoderConfig
        Sizes of the network.
    training, held_out : Examples
        Windows.
    settings : mapping
        What makes this task another one than the next.
    data_sha256 : str
        Hash of all clips.
    device : str
        ``cpu`` or ``cuda``.
    """

    config: AutoencoderConfig
    training: Examples
    held_out: Examples
    settings: Mapping[str, Any]
    data_sha256: str
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """Windows to learn from."""
        return len(self.training)

    def network(self) -> AutoencoderNetwork:
        """Return a fresh network."""
        channels = self.training.frames.shape[1]
        return AutoencoderNetwork(self.config, channels).to(self.device)

    def losses(self, network: AutoencoderNetwork, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return the errors of a batch, in deviations of the training frames."""
        windows, _ = self.training.batch(rows)
        return _errors(network(windows), windows)

    def validation(self, network: AutoencoderNetwork) -> Mapping[str, float]:
        """Return the errors of the windows kept back.

        ``error_of_mean`` is the error of always giving the mean pose of the training frames.
        """
        sums = dict.fromkeys(("loss", "error", "change", "error_of_mean"), 0.0)
        for windows, _ in self.held_out.batches(_AT_ONCE):
            found = dict(_errors(network(windows), windows)) | {
                "error_of_mean": windows.abs().mean()
            }
            for name, value in found.items():
                sums[name] += float(value) * len(windows)
        return {name: value / len(self.held_out) for name, value in sums.items()}


def _errors(rebuilt: Tensor, windows: Tensor) -> Mapping[str, Tensor]:
    error = nn.functional.l1_loss(rebuilt, windows)
    change = nn.functional.l1_loss(rebuilt.diff(dim=1), windows.diff(dim=1))
    return {"loss": error + change, "error": error, "change": change}
