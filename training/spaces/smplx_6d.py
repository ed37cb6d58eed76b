"""A whole SMPL-X body as continuous numbers: 55 joint rotations in 6D, and the translation.

Zhou et al. 2019, "On the Continuity of Rotation Representations in Neural Networks". Of each
rotation matrix the first two rows are kept, as PyTorch3D does and AMUSE's release with it.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.placement import place
from motion.skeleton import JOINT_COUNT

WIDTH: Final = 6 * JOINT_COUNT + 3

FloatArray = NDArray[np.float64]


def smplx_6d_values(clip: MotionClip) -> FloatArray:
    """Return a clip's rotations in 6D and its translation in metres, (T, 333)."""
    return np.concatenate([rotation_rows(clip), clip.trans], axis=1)


def rotation_rows(clip: MotionClip) -> FloatArray:
    """Return the first two rows of each joint's rotation matrix, (T, 330)."""
    matrices = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float)).as_matrix()
    return matrices[:, :2].reshape(len(clip), 6 * JOINT_COUNT)


def smplx_6d_clip(values: FloatArray, frame_rate: float) -> MotionClip:
    """Return the clip of such values.

    Parameters
    ----------
    values : ndarray, shape (T, 333)
        Rows need be neither of length 1 nor at right angles: the nearest rotation whose first row
        points where the given one does is taken (Gram-Schmidt).
    frame_rate : float
        Frames per second.

    Returns
    -------
    MotionClip
        Placed in the study's world: on the floor at the origin, facing +z.
    """
    frames = len(values)
    rows = values[:, : 6 * JOINT_COUNT].reshape(-1, 2, 3)
    first = _unit(rows[:, 0])
    second = _unit(rows[:, 1] - (first * rows[:, 1]).sum(axis=1, keepdims=True) * first)
    matrices = np.stack([first, second, np.cross(first, second)], axis=1)
    turns = Rotation.from_matrix(matrices).as_rotvec().reshape(frames, JOINT_COUNT, 3)
    clip = MotionClip(
        poses=turns.astype(np.float32),
        trans=values[:, 6 * JOINT_COUNT :].astype(np.float32),
        frame_rate=frame_rate,
    )
    return place(clip)[0]


def _unit(vectors: FloatArray) -> FloatArray:
    lengths: FloatArray = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.maximum(lengths, np.finfo(np.float64).tiny)
