"""SMPL-X's 55 joints: names, tree, forward kinematics, and rest positions.

``skeleton.csv`` has each joint's name, the index of its parent, its rest position in metres, and
the rotation of fingers in a relaxed hand.
Source: Pavlakos et al. 2019, "Expressive Body Capture" (SMPL-X); order as in its model files.
"""

import csv
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats, Floats32

_ROWS: Final = tuple(
    csv.DictReader(Path(__file__).with_name("skeleton.csv").read_text("utf-8").splitlines())
)

JOINT_NAMES: Final = tuple(row["joint"] for row in _ROWS)
JOINT_COUNT: Final = len(JOINT_NAMES)
BODY_JOINTS: Final = JOINT_NAMES[:22]
FACE_JOINTS: Final = JOINT_NAMES[22:25]
LEFT_HAND_JOINTS: Final = JOINT_NAMES[25:40]
RIGHT_HAND_JOINTS: Final = JOINT_NAMES[40:]
FINGER_NAMES: Final = ("index", "middle", "pinky", "ring", "thumb")

PARENTS: Final = tuple(int(row["parent"]) for row in _ROWS)
"""Index of each joint's parent; -1 for the pelvis. A parent always comes before its children."""


def joint_index(name: str) -> int:
    """Return the index of joint `name` in `JOINT_NAMES`."""
    return JOINT_NAMES.index(name)


def forward_kinematics(
    poses: NDArray[np.floating], trans: NDArray[np.floating], rest_joints: NDArray[np.floating]
) -> tuple[Floats, Floats]:
    """Return positions and rotations of all joints in the world.

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
    # Imported here: many callers only need the joints' names, and scipy is slow to load.
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


REST_JOINTS: Final[Floats] = np.array([[float(row[axis]) for axis in "xyz"] for row in _ROWS])
"""Joints of the default body in T-pose, shape (55, 3), metres: palms down, y up, facing +z, left at
+x.

Taken from the body that `renderer.look` names (a test compares the two), so that importing or
generating motion needs no mesh.
"""

REST_JOINTS.setflags(write=False)

FINGERS: Final = slice(joint_index("left_index1"), JOINT_COUNT)
"""The finger joints among the 55."""

RELAXED_HANDS: Final[Floats32] = np.array(
    [[float(row[f"relaxed_{axis}"]) for axis in "xyz"] for row in _ROWS[FINGERS]], np.float32
)
"""Shape (30, 3): the finger joints of both hands at rest, axis-angle in radians. Fingers are bent
towards the palm and next to each other; in T-pose they are spread."""

RELAXED_HANDS.setflags(write=False)
