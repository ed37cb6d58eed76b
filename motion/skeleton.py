"""SMPL-X's 55 joints: names, tree, forward kinematics, and rest positions.

``skeleton.csv`` has each joint's name, the index of its parent, and its rest position in metres.
Source: Pavlakos et al. 2019, "Expressive Body Capture" (SMPL-X); order as in its model files.
"""

from __future__ import annotations

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

_FLEXION: Final = {
    "index": (0.30, 0.44, 0.25),
    "middle": (0.34, 0.50, 0.28),
    "pinky": (0.42, 0.52, 0.30),
    "ring": (0.38, 0.54, 0.30),
}
"""Flexion of the three joints of each finger of a relaxed hand, in radians."""

_SPREAD: Final = {"index": 0.09, "middle": -0.05, "pinky": -0.17, "ring": -0.12}
"""Radians by which each left finger turns about y towards the others; in T-pose they are spread."""

_THUMB_ROTATIONS: Final = ((-0.02, 0.26, 0.29), (0.05, 0.10, -0.05), (0.05, 0.10, -0.05))
"""Rotations of the left thumb's joints, axis-angle in radians: next to the index finger."""


def _relaxed_hands() -> Floats32:
    # With the arms out and the palms down, fingers bend about z: left ones turn downwards with a
    # negative angle, right ones, as their mirror images, with a positive one.
    left = np.zeros((len(LEFT_HAND_JOINTS), 3), np.float32)
    for number, name in enumerate(LEFT_HAND_JOINTS):
        finger, phalanx = name.removeprefix("left_")[:-1], int(name[-1]) - 1
        if finger == "thumb":
            left[number] = _THUMB_ROTATIONS[phalanx]
        else:
            left[number] = (0, 0 if phalanx else _SPREAD[finger], -_FLEXION[finger][phalanx])
    hands = np.concatenate([left, left * [1, -1, -1]]).astype(np.float32)
    hands.setflags(write=False)
    return hands


RELAXED_HANDS: Final = _relaxed_hands()
"""Shape (30, 3): the finger joints of both hands at rest, axis-angle in radians."""
