"""SMPL-X's 55 joints: names, tree, forward kinematics, and rest positions.

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
FINGER_NAMES: Final = ("index", "middle", "pinky", "ring", "thumb")
LEFT_HAND_JOINTS: Final = tuple(f"left_{f}{n}" for f in FINGER_NAMES for n in (1, 2, 3))
RIGHT_HAND_JOINTS: Final = tuple(f"right_{f}{n}" for f in FINGER_NAMES for n in (1, 2, 3))
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


REST_JOINTS: Final[NDArray[np.float64]] = np.array(
    [
        (0.0000, -0.3500, 0.0100),  # pelvis
        (0.1127, -0.4350, 0.0200),  # left_hip
        (-0.1127, -0.4350, 0.0200),  # right_hip
        (0.0000, -0.2312, 0.0042),  # spine1
        (0.1226, -0.8595, 0.0528),  # left_knee
        (-0.1226, -0.8595, 0.0528),  # right_knee
        (0.0000, -0.1410, -0.0053),  # spine2
        (0.1432, -1.2890, 0.0266),  # left_ankle
        (-0.1432, -1.2890, 0.0266),  # right_ankle
        (0.0000, -0.0431, -0.0109),  # spine3
        (0.1421, -1.3246, 0.0922),  # left_foot
        (-0.1421, -1.3246, 0.0922),  # right_foot
        (0.0000, 0.1316, 0.0320),  # neck
        (0.0227, 0.0576, 0.0464),  # left_collar
        (-0.0227, 0.0576, 0.0464),  # right_collar
        (0.0000, 0.2295, 0.0652),  # head
        (0.1792, 0.0521, 0.0407),  # left_shoulder
        (-0.1792, 0.0521, 0.0407),  # right_shoulder
        (0.4505, 0.0521, 0.0407),  # left_elbow
        (-0.4505, 0.0521, 0.0407),  # right_elbow
        (0.7027, 0.0521, 0.0407),  # left_wrist
        (-0.7027, 0.0521, 0.0407),  # right_wrist
        (0.0000, 0.2362, 0.0805),  # jaw
        (0.0294, 0.2693, 0.1461),  # left_eye
        (-0.0294, 0.2693, 0.1461),  # right_eye
        (0.8131, 0.0476, 0.0683),  # left_index1
        (0.8405, 0.0476, 0.0703),  # left_index2
        (0.8651, 0.0476, 0.0722),  # left_index3
        (0.8122, 0.0521, 0.0407),  # left_middle1
        (0.8480, 0.0521, 0.0381),  # left_middle2
        (0.8770, 0.0521, 0.0361),  # left_middle3
        (0.7958, 0.0476, 0.0003),  # left_pinky1
        (0.8180, 0.0476, -0.0046),  # left_pinky2
        (0.8341, 0.0476, -0.0082),  # left_pinky3
        (0.8059, 0.0526, 0.0200),  # left_ring1
        (0.8371, 0.0526, 0.0150),  # left_ring2
        (0.8631, 0.0526, 0.0108),  # left_ring3
        (0.7431, 0.0481, 0.0665),  # left_thumb1
        (0.7554, 0.0262, 0.0872),  # left_thumb2
        (0.7826, 0.0073, 0.1075),  # left_thumb3
        (-0.8131, 0.0476, 0.0683),  # right_index1
        (-0.8405, 0.0476, 0.0703),  # right_index2
        (-0.8651, 0.0476, 0.0722),  # right_index3
        (-0.8122, 0.0521, 0.0407),  # right_middle1
        (-0.8480, 0.0521, 0.0381),  # right_middle2
        (-0.8770, 0.0521, 0.0361),  # right_middle3
        (-0.7958, 0.0476, 0.0003),  # right_pinky1
        (-0.8180, 0.0476, -0.0046),  # right_pinky2
        (-0.8341, 0.0476, -0.0082),  # right_pinky3
        (-0.8059, 0.0526, 0.0200),  # right_ring1
        (-0.8371, 0.0526, 0.0150),  # right_ring2
        (-0.8631, 0.0526, 0.0108),  # right_ring3
        (-0.7431, 0.0481, 0.0665),  # right_thumb1
        (-0.7554, 0.0262, 0.0872),  # right_thumb2
        (-0.7826, 0.0073, 0.1075),  # right_thumb3
    ]
)
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


def _relaxed_hands() -> NDArray[np.float32]:
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
