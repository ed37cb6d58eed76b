"""Inverse kinematics of a limb of two bones: shoulder, elbow, wrist, or hip, knee, ankle.

The law of cosines fixes how far the limb bends; the one freedom left, the swivel of the elbow
about the line from shoulder to wrist (Tolani, Goswami & Badler 2000), is set by a pole: the side
to which the elbow points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_STRAIGHTEST: Final = 0.999
_NEAREST: Final = 0.35


@dataclass(frozen=True, kw_only=True, eq=False)
class Limb:
    """A limb as it is when nothing is posed.

    Attributes
    ----------
    upper, lower : ndarray, shape (3,)
        From shoulder to elbow and from elbow to wrist, in metres.
    folds_toward : ndarray, shape (3,)
        Where the wrist goes when only the elbow bends: forward for arms, back for legs.
    comfort : float
        Share of the limb's length up to which it reaches exactly. Beyond, its end lags behind
        smoothly, for a limb that snaps straight looks wrong.
    """

    upper: FloatArray
    lower: FloatArray
    folds_toward: FloatArray
    comfort: float

    @property
    def length(self) -> float:
        """Length of both bones together in metres."""
        return float(np.linalg.norm(self.upper) + np.linalg.norm(self.lower))


def reach(
    limb: Limb, root: FloatArray, target: FloatArray, pole: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return how the two bones are turned so that the limb's end is at `target`.

    Parameters
    ----------
    limb : Limb
    root, target : ndarray, shape (T, 3)
        Where the limb begins and where its end should be, in metres.
    pole : ndarray, shape (T, 3)
        Direction to which the middle joint points; not along the limb.

    Returns
    -------
    upper, lower : ndarray, shape (T, 3, 3)
        World rotation matrices of the bones. The lower one is bent about the hinge alone, its
        twist is left to the caller.
    """
    a, b = float(np.linalg.norm(limb.upper)), float(np.linalg.norm(limb.lower))
    line = target - root
    distance = np.linalg.norm(line, axis=-1, keepdims=True)
    along = line / np.maximum(distance, 1e-9)
    span = _within_reach(distance[..., 0] / (a + b), limb.comfort) * (a + b)
    cosine = np.clip((a**2 + span**2 - b**2) / (2 * a * span), -1, 1)[..., None]
    side = pole - (pole * along).sum(axis=-1, keepdims=True) * along
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    upper = cosine * along + np.sqrt(1 - cosine**2) * side
    lower = (span[..., None] * along - a * upper) / b
    hinge = np.cross(side, along)
    rest_hinge = np.cross(limb.upper, limb.folds_toward)
    return _turn(limb.upper, rest_hinge, upper, hinge), _turn(limb.lower, rest_hinge, lower, hinge)


def _within_reach(share: FloatArray, comfort: float) -> FloatArray:
    """Return the share of the limb's length to span: itself, eased off near a straight limb."""
    room = _STRAIGHTEST - comfort
    over = np.maximum(share - comfort, 0)
    eased = np.minimum(share, comfort) + room * np.tanh(over / room)
    span: FloatArray = np.maximum(eased, _NEAREST)
    return span


def _turn(
    rest: FloatArray, rest_hinge: FloatArray, along: FloatArray, hinge: FloatArray
) -> FloatArray:
    """Return the rotation that takes the bone `rest` along `along`, its hinge along `hinge`."""
    return _frame(along, hinge) @ np.swapaxes(_frame(rest, rest_hinge), -1, -2)


def _frame(along: FloatArray, hinge: FloatArray) -> FloatArray:
    x = along / np.linalg.norm(along, axis=-1, keepdims=True)
    z = np.cross(x, hinge)
    z /= np.linalg.norm(z, axis=-1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=-1)
