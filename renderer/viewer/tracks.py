"""A motion clip as a compact track."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.body.model import BodyModel
from motion.clip import MotionClip
from renderer.viewer.packing import pack, quantise

TURN_STEP: Final = 8e-4
"""Radians. A rotation is never further off than its axis-angle vector, which is at most half a
step off along each axis: 0.0397 degrees."""

_SHIFT_STEP: Final = 1e-4
_WEIGHT_STEP: Final = 0.004


def track(clip: MotionClip, body: BodyModel) -> bytes:
    """Return the track of `clip` on `body`, to be read by ``viewer.js``.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    body : BodyModel
        Says what the clip's face does.

    Returns
    -------
    bytes
        Made by `pack`: joints' axis-angle vectors, shape (T, 165), the body's translation,
        (T, 3), and weights of the body's expressions, (T, E), each in steps that the facts tell.
    """
    turns = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float)).as_rotvec()
    weights = body.expression_weights(clip)
    if weights is None:
        weights = np.zeros((len(clip), 0), np.float32)
    stepped = {
        "turns": quantise(turns.reshape(len(clip), -1), TURN_STEP),
        "shifts": quantise(clip.trans, _SHIFT_STEP),
        "weights": quantise(weights, _WEIGHT_STEP),
    }
    return pack(
        {
            "rate": clip.frame_rate,
            "steps": {name: step for name, (_, step) in stepped.items()},
        },
        {name: numbers for name, (numbers, _) in stepped.items()},
    )
