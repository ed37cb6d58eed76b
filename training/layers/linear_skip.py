"""A skip past all layers for the noise that follows from the motion's covariance alone."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from training.diffusion import LINEAR


class LinearSkip(nn.Module):
    """Adds to what layers answer the best linear estimate of the noise.

    Motion is seen as waves of poses: along the directions in which poses vary together (principal
    components), and in time as cosines (DCT-II). Each wave's variance is known, and with it how
    much of what is seen of it is noise (Wiener 1949). In waves that no motion has, all is noise;
    layers that are narrower than a pose need not carry it. Until variances are told, every wave
    has that of a normalised value, 1.

    The rest is what layers answer, times √ᾱ. With variances of 1 that is the velocity of Salimans
    & Ho 2022. The clean motion that follows from both misses the linear estimate of it by √(1 - ᾱ)
    times the answer, at no step by more than the answer.

    Parameters
    ----------
    frames : int
        Frames of the windows that are learned from.
    part : int
        Values of a frame.
    """

    directions: Tensor
    variances: Tensor

    def __init__(self, frames: int, part: int) -> None:
        super().__init__()
        self.register_buffer("directions", torch.eye(part))
        self.register_buffer("variances", torch.ones(frames, part))

    def fit(self, windows: NDArray[np.float32]) -> None:
        """Take the variances of normalised motion, (windows, frames, part)."""
        frames, part = windows.shape[1:]
        poses = windows.reshape(-1, part).astype(np.float64)
        _, directions = np.linalg.eigh(poses.T @ poses / len(poses))
        waves = _cosines(frames) @ (windows @ directions)
        self.directions.copy_(torch.from_numpy(directions))
        self.variances.copy_(torch.from_numpy(np.square(waves).mean(axis=0)))

    def forward(self, answer: Tensor, noisy: Tensor, steps: Tensor) -> Tensor:
        """Return the noise in `noisy`, by what layers `answer`.

        Parameters
        ----------
        answer, noisy : Tensor
            (batch, frames, part); the frames may be fewer than a window's.
        steps : Tensor
            (batch,) or (1,) diffusion steps.
        """
        # Where most is signal, noise is a small difference, which half precision does not hold.
        with _full_precision(noisy.device.type):
            noisy = noisy.float()
            alpha = LINEAR.alpha_bar_at(steps, noisy)
            cosines = torch.as_tensor(
                _cosines(noisy.shape[1]), dtype=torch.float32, device=noisy.device
            )
            shares = (1 - alpha).sqrt() / (alpha * self._variances(noisy.shape[1]) + (1 - alpha))
            waves = cosines @ (noisy @ self.directions)
            linear = (cosines.T @ (shares * waves)) @ self.directions.T
            return linear + alpha.sqrt() * answer.float()

    def _variances(self, frames: int) -> Tensor:
        """Return the variances of the waves in so many frames, by how fast they are."""
        full = len(self.variances)
        if frames == full:
            return self.variances
        places = torch.arange(frames, device=self.variances.device) * (full / frames)
        places = places.clamp(max=full - 1)
        lower = places.floor().long()
        upper = (lower + 1).clamp(max=full - 1)
        share = (places - lower)[:, None]
        return (1 - share) * self.variances[lower] + share * self.variances[upper]


def _full_precision(device: str) -> AbstractContextManager[object]:
    """Keep torch's autocast away, which devices without numbers (meta) do not have."""
    return nullcontext() if device == "meta" else torch.autocast(device, enabled=False)


@cache
def _cosines(frames: int) -> NDArray[np.float64]:
    """Return the orthonormal DCT-II of so many frames, (waves, frames)."""
    waves, times = np.arange(frames)[:, None], np.arange(frames) + 0.5
    cosines: NDArray[np.float64] = np.cos(np.pi * waves * times / frames) * np.sqrt(2 / frames)
    cosines[0] /= np.sqrt(2)
    return cosines
