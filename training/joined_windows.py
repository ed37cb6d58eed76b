"""Motion of any length in windows that go over into each other, and the speech under them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from motion.audio import SPEECH_RATE, Audio
from training.hearing.spectra import check_speech, filterbank
from training.hearing.speech_frames import at_speech_rate


@dataclass(frozen=True, kw_only=True)
class WindowPlan:
    """How many windows cover a motion, and where each begins.

    Attributes
    ----------
    frames : int
        Of a window.
    stride : int
        Frames from the beginning of one window to that of the next.
    count : int
        Windows, from 1.
    fade : int
        Frames at a window's beginning in which it takes over from the one before.
    """

    frames: int
    stride: int
    count: int
    fade: int = 0

    @property
    def starts(self) -> list[int]:
        """First frame of each window."""
        return [self.stride * number for number in range(self.count)]

    def join(self, windows: Tensor) -> Tensor:
        """Return windows (count, frames, width) as one motion, (frames in all, width).

        A window takes over from the one before along a quintic, whose speed and acceleration are
        zero at both ends (Flash & Hogan 1985).
        """
        share = (torch.arange(self.fade, device=windows.device) + 1) / (self.fade + 1)
        weight = (share**3 * (10 - 15 * share + 6 * share**2))[:, None]
        motion = windows.new_empty(self.starts[-1] + self.frames, windows.shape[-1])
        motion[: self.frames] = windows[0]
        for window, start in zip(windows[1:], self.starts[1:], strict=True):
            faded = start + self.fade
            motion[start:faded] = torch.lerp(motion[start:faded], window[: self.fade], weight)
            motion[faded : start + self.frames] = window[self.fade :]
        return motion


def plan_windows(total: int, frames: int, fade: int) -> WindowPlan:
    """Return the fewest windows that cover `total` frames and share at least `fade`.

    They share as much as they can, so that the last hardly reaches beyond the speech.
    """
    count = 1 if total <= frames else 1 + math.ceil((total - frames) / (frames - fade))
    stride = frames if count == 1 else math.ceil((total - frames) / (count - 1))
    return WindowPlan(frames=frames, stride=stride, count=count, fade=fade)


def filterbanks_under(
    audio: Audio, plan: WindowPlan, frame_rate: float, rows: int, bands: int
) -> list[Tensor]:
    """Return the standardised filterbank (1, rows, bands) of the speech under each window.

    Raises
    ------
    InputError
        If the speech is shorter than half a second, or silent.
    """
    samples = at_speech_rate(audio)
    check_speech(samples)
    ends = [
        [round(frame * SPEECH_RATE / frame_rate) for frame in (start, start + plan.frames)]
        for start in plan.starts
    ]
    return [filterbank(samples[first:last], rows, bands)[None] for first, last in ends]
