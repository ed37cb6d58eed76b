"""A trained feature network: clips in, embeddings out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators import network_names as names
from analysis.evaluators.clip_views import TOLERANCE, cut_windows, long_enough
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.files import sha256_of
from motion.resample import resample

if TYPE_CHECKING:
    from torch import Tensor

    from analysis.evaluators.clip_views import ClipView
    from analysis.evaluators.evaluator_file import EvaluatorFile

FloatArray = NDArray[np.float32]

_BATCH_SIZE: Final = 64

_SHOWN_OF_HASH: Final = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluator:
    """A trained feature network.

    Attributes
    ----------
    sha256 : str
        Hash of its file, which every score quotes.
    file : EvaluatorFile
        The content of the file.
    """

    sha256: str
    file: EvaluatorFile

    @property
    def name(self) -> str:
        """A name in `analysis.evaluators.network_names`."""
        return names.OF_CHANNELS[self.file.facts.channels]

    @property
    def rule(self) -> None:
        """None: no published code computes distances in its features."""
        return None

    @property
    def frame_rate(self) -> float:
        """Frames per second to which clips are resampled."""
        return self.file.facts.network.frame_rate

    @property
    def window(self) -> int:
        """Frames of a window."""
        return self.file.facts.network.window

    @property
    def labels(self) -> tuple[str, ...]:
        """The emotions of `classify`, in its order; empty but for the kind ``emotion``."""
        return self.file.facts.labels

    @cached_property
    def _view(self) -> ClipView:
        return self.file.facts.view(self.file.landmarks)

    def embed(self, clip: MotionClip) -> FloatArray:
        """Return the embedding of each window of a clip.

        Parameters
        ----------
        clip : MotionClip
            Of any frame rate. Channels that were frozen in training are frozen.

        Returns
        -------
        ndarray, shape (windows, d), float32
            Windows do not overlap, from the first frame on; an incomplete last one is left out.

        Raises
        ------
        InputError
            If the clip is shorter than one window, or lacks the network's input.
        """
        import torch

        windows = torch.from_numpy(self._windows(clip))
        with torch.inference_mode():
            return _finite(in_batches(self.file.network.embed, windows).numpy())

    def classify(self, clip: MotionClip) -> FloatArray:
        """Return the probability of each emotion in each window of a clip.

        Returns
        -------
        ndarray, shape (windows, len(labels)), float32
            Rows sum to 1.

        Raises
        ------
        InputError
            As `embed`; or if the network classifies no emotions.
        """
        import torch

        if not self.labels:
            raise InputError(
                f"a network of kind {self.file.facts.kind!r} classifies no emotions",
                remedy="Use one of kind emotion ('motionjury train evaluator emotion')",
            )
        windows = torch.from_numpy(self._windows(clip))
        with torch.inference_mode():
            return _finite(in_batches(self.file.network, windows).softmax(dim=1).numpy())

    def _windows(self, clip: MotionClip) -> FloatArray:
        """Return the windows of a clip as the network's input, shape (n, window, channels)."""
        facts = self.file.facts
        frames = self._view.frames(resample(freeze(clip, facts.frozen), self.frame_rate))
        frames = long_enough(self.file.normalisation(frames), self.window, self.frame_rate)
        return cut_windows(frames, self.window, self.window)

    def describe(self) -> Mapping[str, str]:
        """Return the settings that every score of this network quotes, in words."""
        facts = self.file.facts
        data = facts.data
        seconds = self.window / self.frame_rate
        described = {
            "feature network": facts.named(),
            "network sha256": self.sha256[:_SHOWN_OF_HASH],
            "representation": f"{self._view.described()}, in deviations of the training frames",
            "frame rate": f"{self.frame_rate:g} fps, resampled",
            "window": f"{self.window} frames ({seconds:.4g} s), not overlapping; a clip that is "
            f"up to {TOLERANCE:g} s too short holds its last frame",
            "trained on": f"{data.clips} clips of {data.recordings} recordings, {data.windows} "
            f"windows, data sha256 {data.sha256[:_SHOWN_OF_HASH]}",
            "held out": f"{data.held_out}: {self._held_out()}",
        }
        if facts.frozen:
            described["held still"] = ", ".join(facts.frozen)
        return MappingProxyType(described)

    def _held_out(self) -> str:
        facts = self.file.facts
        count = f"{facts.data.held_out_windows} windows"
        if facts.kind == "emotion":
            return (
                f"accuracy {facts.held_out['accuracy']:.3f} of {count} (always the most frequent "
                f"emotion: {facts.held_out['largest_share']:.3f})"
            )
        return (
            f"reconstruction error {facts.held_out['error']:.3f} deviations of {count} (always "
            f"the mean pose: {facts.held_out['error_of_mean']:.3f})"
        )


def load_evaluator(path: Path) -> Evaluator:
    """Read a feature network that ``motionjury train evaluator`` wrote.

    Raises
    ------
    InputError
        If the file is missing, damaged, another program's, of another version or changed.
    """
    from analysis.evaluators.evaluator_file import read_evaluator

    path = Path(path)
    file = read_evaluator(path)
    return Evaluator(sha256=sha256_of(path), file=file)


def in_batches(network: Callable[[Tensor], Tensor], windows: Tensor) -> Tensor:
    """Return a network's output for windows, shape (n, ...), computed in batches."""
    import torch

    starts = range(0, len(windows), _BATCH_SIZE)
    return torch.cat([network(windows[start : start + _BATCH_SIZE]) for start in starts])


def _finite(values: NDArray[np.float32]) -> FloatArray:
    if not np.isfinite(values).all():
        raise InputError(
            "the feature network returned a value that is not a number",
            remedy="Train the network again",
        )
    return values
