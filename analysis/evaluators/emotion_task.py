"""Learning to tell the emotion of a motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from analysis.evaluators.emotion_network import EmotionConfig, EmotionNetwork
from analysis.evaluators.examples import Examples

_AT_ONCE: Final = 64


@dataclass(frozen=True, kw_only=True, eq=False)
class EmotionTask:
    """Cross-entropy alone, as AMUSE's appendix D has it.

    Attributes
    ----------
    config : EmotionConfig
        Sizes of the network.
    emotions : int
        How many there are.
    training, held_out : Examples
        Windows with labels.
    settings : mapping
        What makes this task another one than the next.
    data_sha256 : str
        Hash of all clips.
    device : str
        ``cpu`` or ``cuda``.
    """

    config: EmotionConfig
    emotions: int
    training: Examples
    held_out: Examples
    settings: Mapping[str, Any]
    data_sha256: str
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """Windows to learn from."""
        return len(self.training)

    def network(self) -> EmotionNetwork:
        """Return a fresh network."""
        channels = self.training.frames.shape[1]
        return EmotionNetwork(self.config, channels, self.emotions).to(self.device)

    def losses(self, network: EmotionNetwork, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return the cross-entropy of a batch."""
        windows, labels = self.training.batch(rows)
        return {"loss": nn.functional.cross_entropy(network(windows), labels)}

    def validation(self, network: EmotionNetwork) -> Mapping[str, float]:
        """Return cross-entropy and accuracy of the windows kept back.

        ``largest_share`` is the accuracy of always naming the most frequent emotion.
        """
        loss = right = 0.0
        for windows, labels in self.held_out.batches(_AT_ONCE):
            logits = network(windows)
            loss += float(nn.functional.cross_entropy(logits, labels, reduction="sum"))
            right += float((logits.argmax(dim=1) == labels).sum())
        count = len(self.held_out)
        largest = int(torch.bincount(self.held_out.labels).max())
        return {
            "loss": loss / count,
            "accuracy": right / count,
            "largest_share": largest / count,
        }
