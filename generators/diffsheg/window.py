"""Sampling one window of motion, on its own or continuing the one before."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from torch import Tensor

from generators.diffsheg.speech_frames import SpeechFrames
from generators.diffsheg.walk import CLEAN, Sampling
from generators.diffusion import LINEAR

Estimate = Callable[[Tensor, int], Tensor]
"""Says which noise is in a noisy window, (1, frames, width), at a place of the walk."""


@dataclass(frozen=True, eq=False)
class WindowNoise:
    """All noise of one window's walk, drawn before it begins: parts of a motion can walk apart.

    Attributes
    ----------
    start : Tensor
        (1, frames, values), where the walk begins.
    later : tuple of Tensor
        (1, frames, values) for each step of a window that continues another one; none otherwise.
    """

    start: Tensor
    later: tuple[Tensor, ...]

    @property
    def continues(self) -> bool:
        """Whether the window continues another one."""
        return bool(self.later)

    def part(self, values: slice) -> WindowNoise:
        """Return the noise of some of a frame's values."""
        return WindowNoise(self.start[..., values], tuple(one[..., values] for one in self.later))

    def to(self, device: torch.device) -> WindowNoise:
        """Return the same noise on a device."""
        return WindowNoise(self.start.to(device), tuple(one.to(device) for one in self.later))


@dataclass(frozen=True, eq=False)
class Window:
    """What a window's motion is made of; as many frames of noise as of speech."""

    speech: SpeechFrames
    noise: WindowNoise


def draw_noise(
    shape: tuple[int, int], sampling: Sampling, random: torch.Generator, *, continues: bool
) -> WindowNoise:
    """Return the noise of a window of `shape`, frames and values, which may continue another one.

    It is drawn where `random` is, so that other devices move alike.
    """
    steps = len(sampling.later_walk) - 1 if continues else 0
    start, *later = (torch.randn(1, *shape, generator=random) for _ in range(1 + steps))
    return WindowNoise(start, tuple(later))


def sample_windows(
    windows: Iterable[tuple[Estimate, WindowNoise]], sampling: Sampling, known: Tensor | None
) -> list[Tensor]:
    """Return the motion of windows of which each continues the one before; see `sample_window`."""
    made = []
    for estimate, noise in windows:
        motion = sample_window(estimate, sampling, noise, known)
        known = shared_frames(motion, sampling)
        made.append(motion)
    return made


def shared_frames(motion: Tensor, sampling: Sampling) -> Tensor | None:
    """Return the last frames of a window, which the next one continues; None where it does not."""
    return motion[-sampling.overlap :] if sampling.overlap else None


def sample_window(
    estimate: Estimate, sampling: Sampling, noise: WindowNoise, known: Tensor | None = None
) -> Tensor:
    """Return a window of motion, or a part of one.

    Parameters
    ----------
    estimate : Estimate
        The network, told the speech.
    sampling : Sampling
        How to walk.
    noise : WindowNoise
        Of as many values as `estimate` reads.
    known : Tensor, optional
        (overlap, values), the last frames of the window before, which the first frames continue.

    Returns
    -------
    Tensor
        (frames, values); the first frames are `known`, blended into what follows.
    """
    walk = sampling.first_walk if known is None else sampling.later_walk
    kept = _kept(sampling)
    motion, later = noise.start, iter(noise.later)
    if known is not None and sampling.keeps_pose:
        pose = torch.cat([known, known[-1:].expand(motion.shape[1] - len(known), -1)])
        motion = np.sqrt(kept(walk[0])) * pose + np.sqrt(1 - kept(walk[0])) * motion
    for here, there in pairwise(walk):
        if there > here:
            share = kept(there) / kept(here)
            motion = np.sqrt(share) * motion + np.sqrt(1 - share) * next(later)
            continue
        found = estimate(motion, here)
        clean = (motion - np.sqrt(1 - kept(here)) * found) / np.sqrt(kept(here))
        motion = np.sqrt(kept(there)) * clean + np.sqrt(1 - kept(there)) * found
        if known is not None:
            spread = float(np.sqrt(1 - kept(there)))
            fresh = next(later)
            shared = (found if sampling.own_noise else fresh)[0, : len(known)]
            seen = np.sqrt(kept(there)) * known + spread * shared
            weight = _weight(known, blends=spread < sampling.blend_below)
            motion[0, : len(known)] = weight * seen + (1 - weight) * motion[0, : len(known)]
    return motion[0]


def _kept(sampling: Sampling) -> Callable[[int], float]:
    """Return the share of the signal's variance that is left at each place."""

    def kept(place: int) -> float:
        return 1.0 if place == CLEAN else float(LINEAR.kept[sampling.timesteps[place]])

    return kept


def _weight(known: Tensor, *, blends: bool) -> Tensor:
    """Return how much each shared frame is that of the window before, (overlap, 1)."""
    overlap = len(known)
    falls = torch.arange(overlap, dtype=torch.float32, device=known.device) / max(overlap, 1)
    return (1 - falls if blends else torch.ones_like(falls))[:, None]
