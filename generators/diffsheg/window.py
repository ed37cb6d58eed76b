"""Sampling one window of motion, on its own or continuing the one before."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import torch
from torch import Tensor

from generators.diffsheg.walk import CLEAN, Sampling
from generators.diffusion import LINEAR

Estimate = Callable[[Tensor, int], Tensor]
"""Says which noise is in a noisy window, (1, frames, width), at a place of the walk."""


def sample_window(
    estimate: Estimate,
    shape: tuple[int, int],
    sampling: Sampling,
    random: torch.Generator,
    known: Tensor | None = None,
) -> Tensor:
    """Return a window of motion.

    Parameters
    ----------
    estimate : Estimate
        The network, told the speech.
    shape : (int, int)
        Frames and values of a frame.
    sampling : Sampling
        How to walk.
    random : Generator
        Where all noise comes from.
    known : Tensor, optional
        (overlap, values), the last frames of the window before, which the first frames continue.

    Returns
    -------
    Tensor
        `shape`; its first frames are `known`, blended into what follows.
    """
    walk = sampling.first_walk if known is None else sampling.later_walk
    kept = _kept(sampling)

    def noise() -> Tensor:
        return torch.randn(1, *shape, generator=random)

    motion = noise()
    for here, there in pairwise(walk):
        if there > here:
            share = kept(there) / kept(here)
            motion = np.sqrt(share) * motion + np.sqrt(1 - share) * noise()
            continue
        found = estimate(motion, here)
        clean = (motion - np.sqrt(1 - kept(here)) * found) / np.sqrt(kept(here))
        motion = np.sqrt(kept(there)) * clean + np.sqrt(1 - kept(there)) * found
        if known is not None:
            spread = float(np.sqrt(1 - kept(there)))
            seen = np.sqrt(kept(there)) * known + spread * noise()[0, : len(known)]
            weight = _weight(len(known), blends=spread < sampling.blend_below)
            motion[0, : len(known)] = weight * seen + (1 - weight) * motion[0, : len(known)]
    return motion[0]


def _kept(sampling: Sampling) -> Callable[[int], float]:
    """Return the share of the signal's variance that is left at each place."""

    def kept(place: int) -> float:
        return 1.0 if place == CLEAN else float(LINEAR.kept[sampling.timesteps[place]])

    return kept


def _weight(overlap: int, *, blends: bool) -> Tensor:
    """Return how much each shared frame is that of the window before, (overlap, 1)."""
    if not blends:
        return torch.ones(overlap, 1)
    return (1 - torch.arange(overlap, dtype=torch.float32) / overlap)[:, None]
