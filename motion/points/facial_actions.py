"""From how landmarks of a face shift to the facial actions that shift them so."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import BodyModel
from motion.clip import ARKIT_COUNT
from motion.errors import InputError

FloatArray = NDArray[np.float32]

_FARTHEST: Final = 0.2
"""Metres beyond which no landmark of a face shifts."""

EXACT: Final = 3e-4
"""Metres of misfit that count as much as a weight of 1, of landmarks without noise: only what no
landmark shows stays 0."""

_SWEEPS: Final = 200
_SETTLED: Final = 1e-4
"""A sweep that changes no weight by more ends the search."""


def facial_actions(shifts: FloatArray, body: BodyModel, *, misfit: float = EXACT) -> FloatArray:
    """Return the weights of ARKit's facial actions that shift the landmarks nearest to `shifts`.

    Least squares with all weights in [0, 1], by coordinate descent in all frames at once.

    Parameters
    ----------
    shifts : ndarray, shape (T, L, 3)
        From the neutral face, in the head's frame, metres, in the order of
        `FaceLandmarks.of(body)`.
    body : BodyModel
        The body whose facial actions they are.
    misfit : float
        Metres of misfit, over all landmarks, that count as much as a weight of 1. Noisy landmarks
        need more, so that no action explains their noise.

    Returns
    -------
    ndarray, shape (T, 52), float32

    Raises
    ------
    InputError
        If the body shows no facial actions, or the landmarks are not as stated.
    """
    if not body.has_arkit_slots:
        raise InputError(
            "the body shows no ARKit facial actions, which landmarks are turned into",
            remedy="Name an avatar instead of this body under [video] in study.toml",
        )
    landmarks = FaceLandmarks.of(body)
    _check(shifts, landmarks.count)
    directions = landmarks.body.expression_directions[: landmarks.count]
    slots = min(directions.shape[2], ARKIT_COUNT)
    effects = directions[:, :, :slots].reshape(-1, slots).astype(np.float64)
    flat = shifts.reshape(len(shifts), -1).astype(np.float64)
    weights = np.zeros((len(shifts), ARKIT_COUNT), np.float32)
    weights[:, :slots] = _bounded(effects, flat, misfit).T
    return weights


def _bounded(
    effects: NDArray[np.float64], wanted: NDArray[np.float64], misfit: float
) -> NDArray[np.float64]:
    """Return the weights (K, T) in [0, 1] by which `effects` (P, K) come nearest to `wanted`."""
    normal = effects.T @ effects + misfit**2 * np.eye(effects.shape[1])
    aims = effects.T @ wanted.T
    weights = np.clip(np.linalg.solve(normal, aims), 0, 1)
    for _ in range(_SWEEPS):
        before = weights.copy()
        for k, row in enumerate(normal):
            left = aims[k] - row @ weights
            weights[k] = np.clip(weights[k] + left / row[k], 0, 1)
        if np.abs(weights - before).max() < _SETTLED:
            break
    return np.asarray(weights)


def _check(shifts: FloatArray, count: int) -> None:
    if shifts.ndim != 3 or shifts.shape[1:] != (count, 3):
        raise InputError(
            f"the landmarks have shape {shifts.shape}",
            remedy=f"Give (frames, {count}, 3): the landmarks that FaceLandmarks.of(body) chooses",
        )
    if not np.isfinite(shifts).all():
        frame, landmark = map(int, np.argwhere(~np.isfinite(shifts))[0, :2])
        raise InputError(
            f"landmark {landmark} is not a number in frame {frame}",
            remedy="Fill the gap or leave the frame out",
        )
    farthest = float(np.linalg.norm(shifts, axis=2).max(initial=0))
    if farthest > _FARTHEST:
        raise InputError(
            f"a landmark shifts by {farthest:.3g} m, farther than any face moves",
            remedy="Give metres, as shifts from the neutral face while the head is held still",
        )
