"""SHOW's motion as DiffSHEG tells it: 43 joints, the jaw and 100 expressions, all SMPL-X's own."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import MotionClip
from motion.hands import FINGERS, RELAXED_HANDS, added_to_mean_hands
from motion.placement import place
from motion.skeleton import JOINT_COUNT, joint_index

FloatArray = NDArray[np.float64]

TOLD_OF_TRUNK: Final = (
    "spine1", "spine2", "spine3", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
)  # fmt: skip
"""The 13 joints that come first, in SMPL-X's order; both hands' 30 follow."""

TOLD_JOINTS: Final = (
    *(joint_index(name) for name in TOLD_OF_TRUNK),
    *range(FINGERS.start, FINGERS.stop),
)
_BODY: Final = 3 * len(TOLD_JOINTS)
_JAW: Final = slice(_BODY, _BODY + 3)


def show_values(clip: MotionClip) -> FloatArray:
    """Return what DiffSHEG tells of a clip whose fingers are relative to SMPL-X's mean hands.

    Returns
    -------
    ndarray, shape (T, 232)
        Rotations, axis-angle in radians; jaw; expression coefficients, 0 where the clip has none.
    """
    frames = len(clip)
    expressions = np.zeros((frames, 100)) if clip.expressions is None else clip.expressions
    body = clip.poses[:, list(TOLD_JOINTS)].reshape(frames, _BODY)
    jaw = clip.poses[:, joint_index("jaw")]
    return np.concatenate([body, jaw, expressions], axis=1, dtype=np.float64)


def show_clip(values: FloatArray, frame_rate: float) -> MotionClip:
    """Return DiffSHEG's motion as a clip.

    SHOW tells fingers relative to SMPL-X's mean hands, which only a licensed model holds; relaxed
    hands take their place.

    Parameters
    ----------
    values : ndarray, shape (T, 232)
        See `show_values`.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MotionClip
        Standing on the floor at the origin, facing +z; hips and legs stand still.
    """
    frames = len(values)
    poses = np.zeros((frames, JOINT_COUNT, 3))
    poses[:, list(TOLD_JOINTS)] = values[:, :_BODY].reshape(frames, len(TOLD_JOINTS), 3)
    poses[:, joint_index("jaw")] = values[:, _JAW]
    clip = MotionClip(
        poses=poses.astype(np.float32),
        trans=np.zeros((frames, 3), np.float32),
        frame_rate=frame_rate,
        expressions=values[:, _JAW.stop :].astype(np.float32),
    )
    return place(added_to_mean_hands(clip, RELAXED_HANDS))[0]
