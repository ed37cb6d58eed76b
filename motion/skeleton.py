"""SMPL-X's 55 joints: names, tree, and forward kinematics.

Source: Pavlakos et al. 2019, "Expressive Body Capture" (SMPL-X); order as in its model files.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

BODY_JOINTS: Final = (
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2",
    "left_ankle", "right_ankle", "spine3", "left_foot", "right_foot", "neck", "left_collar",
    "right_collar", "head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow",
    "left_wrist", "right_wrist",
)  # fmt: skip
FACE_JOINTS: Final = ("jaw", "left_eye", "right_eye")
_FINGERS: Final = ("index", "middle", "pinky", "ring", "thumb")
LEFT_HAND_JOINTS: Final = tuple(f"left_{f}{n}" for f in _FINGERS for n in (1, 2, 3))
RIGHT_HAND_JOINTS: Final = tuple(f"right_{f}{n}" for f in _FINGERS for n in (1, 2, 3))
JOINT_NAMES: Final = (*BODY_JOINTS, *FACE_JOINTS, *LEFT_HAND_JOINTS, *RIGHT_HAND_JOINTS)
JOINT_COUNT: Final = len(JOINT_NAMES)

_BODY_PARENTS: Final = (
    -1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19,
)  # fmt: skip


def _hand_parents(wrist: int, first: int) -> list[int]:
    return [wrist if k % 3 == 0 else first + k - 1 for k in range(15)]


PARENTS: Final = (
    *_BODY_PARENTS,
    *(15, 15, 15),
    *_hand_parents(20, 25),
    *_hand_parents(21, 40),
)
"""Index of each joint's parent; -1 for the pelvis. A parent always comes before its children."""


def joint_index(name: str) -> int:
    """Return the index of joint `name` in `JOINT_NAMES`."""
    return JOINT_NAMES.index(name)


def forward_kinematics(
    poses: NDArray[np.floating],
    trans: NDArray[np.floating],
    rest_joints: NDArray[np.floating],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where each joint is and how it is turned in the world.

    Parameters
    ----------
    poses : ndarray, shape (T, 55, 3)
        Rotations relative to the parent, axis-angle in radians.
    trans : ndarray, shape (T, 3)
        Translation in metres.
    rest_joints : ndarray, shape (55, 3)
        Joint positions of the unposed body in metres.

    Returns
    -------
    positions : ndarray, shape (T, 55, 3)
        Joint positions in metres.
    rotations : ndarray, shape (T, 55, 3, 3)
        World rotation matrices.
    """
    # Names of joints are needed where nothing is turned, and scipy is slow to load.
    from scipy.spatial.transform import Rotation

    frames = len(poses)
    local = Rotation.from_rotvec(np.asarray(poses, float).reshape(-1, 3)).as_matrix()
    local = local.reshape(frames, JOINT_COUNT, 3, 3)
    rotations = np.empty_like(local)
    positions = np.empty((frames, JOINT_COUNT, 3))
    for joint, parent in enumerate(PARENTS):
        if parent < 0:
            rotations[:, joint] = local[:, joint]
            positions[:, joint] = rest_joints[joint] + trans
            continue
        offset = rest_joints[joint] - rest_joints[parent]
        rotations[:, joint] = rotations[:, parent] @ local[:, joint]
        positions[:, joint] = positions[:, parent] + rotations[:, parent] @ offset
    return positions, rotations
