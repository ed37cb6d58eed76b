"""From what was heard to motion: latents by DDIM, decoded window by window and joined.

Chhatre et al., CVPR 2024, sections 3.3 and 4: ten seconds each, 50 of 1000 steps. Longer speech is
cut into windows that share a second, in which one goes over into the next.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import torch
from torch import Tensor

from generators.amuse.model import Denoiser, MotionPrior, NoPrior
from training.diffusion import SCALED_LINEAR

STEPS: Final = 50

_AT_ONCE: Final = 8
"""Windows that are decoded together, so that memory does not grow with the speech."""


@dataclass(frozen=True)
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
    fade: int

    @property
    def starts(self) -> list[int]:
        """First frame of each window."""
        return [self.stride * number for number in range(self.count)]


def plan_windows(total: int, frames: int, fade: int) -> WindowPlan:
    """Return the fewest windows that cover `total` frames and share at least `fade`.

    They share as much as they can, so that the last hardly reaches beyond the speech.
    """
    count = 1 if total <= frames else 1 + math.ceil((total - frames) / (frames - fade))
    stride = frames if count == 1 else math.ceil((total - frames) / (count - 1))
    return WindowPlan(frames=frames, stride=stride, count=count, fade=fade)


@torch.inference_mode()
def sample_windows(
    prior: MotionPrior | NoPrior,
    denoiser: Denoiser,
    latents: Sequence[Tensor],
    noise: Tensor,
    steps: int = STEPS,
) -> Tensor:
    """Return the motion of windows, (windows, frames, motion width).

    Parameters
    ----------
    prior, denoiser : Module
        In evaluation mode, on one device.
    latents : sequence of Tensor
        Content, emotion and style, (windows, condition width) each.
    noise : Tensor
        (windows, tokens, width), with which sampling begins: equal noise gives equal motion.
    steps : int
        Of DDIM.
    """
    conditions = [latent[:, None] for latent in latents]

    def eps_of(z_t: Tensor, t: Tensor) -> Tensor:
        eps: Tensor = denoiser(z_t, t, *conditions)
        return eps

    z = SCALED_LINEAR.ddim(noise, eps_of, steps)
    return torch.cat([prior.decode(part) for part in torch.split(z, _AT_ONCE)])


def join_windows(windows: Tensor, plan: WindowPlan) -> Tensor:
    """Return windows (count, frames, width) as one motion, (frames in all, width).

    A window takes over from the one before along a quintic, whose speed and acceleration are zero
    at both ends (Flash & Hogan 1985).
    """
    share = (torch.arange(plan.fade, device=windows.device) + 1) / (plan.fade + 1)
    weight = (share**3 * (10 - 15 * share + 6 * share**2))[:, None]
    motion = windows.new_empty(plan.starts[-1] + plan.frames, windows.shape[-1])
    motion[: plan.frames] = windows[0]
    for window, start in zip(windows[1:], plan.starts[1:], strict=True):
        faded = start + plan.fade
        motion[start:faded] = torch.lerp(motion[start:faded], window[: plan.fade], weight)
        motion[faded : start + plan.frames] = window[plan.fade :]
    return motion
