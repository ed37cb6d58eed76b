"""Speech as DiffSHEG's network hears it."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True, eq=False)
class SpeechFrames:
    """What is known of the speech, frame by frame.

    Attributes
    ----------
    mel : Tensor
        (frames, mel bands).
    hubert : Tensor
        (frames, speech features).
    """

    mel: Tensor
    hubert: Tensor

    def __len__(self) -> int:
        return len(self.mel)

    def part(self, first: int, last: int | None = None) -> SpeechFrames:
        """Return some of the frames."""
        return SpeechFrames(self.mel[first:last], self.hubert[first:last])

    def then(self, more: SpeechFrames) -> SpeechFrames:
        """Return these frames followed by `more`."""
        return SpeechFrames(torch.cat([self.mel, more.mel]), torch.cat([self.hubert, more.hubert]))
