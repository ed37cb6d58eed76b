"""What each joint of a posed body does to the skin, with extra joints that share out twists.

Linear blend skinning averages matrices. Where two joints differ by a large turn about the bone
between them, as elbow and wrist do when a palm turns up, the average shrinks and the skin is wrung
like a candy wrapper. Extra joints along the bone, turned by a growing share of that twist, leave
only small differences to average. Decomposition into swing and twist: Dobrowolski 2015,
"Swing-twist decomposition in Clifford algebra", section 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.skeleton import JOINT_COUNT, PARENTS

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class TwistJoints:
    """Extra joints that turn about a bone; they come after the 55 of the skeleton.

    Each turns as the joint at which its bone starts, and beyond that about the bone by a share of
    the twists that the joints at both ends make about it.

    Attributes
    ----------
    bones : ndarray, shape (K, 2), int
        The joints between which the bone lies that each extra joint turns about.
    shares : ndarray, shape (K, 2), float64
        How much of the twist of the joint at the start, and of the one at the end, is added.
        The skin at the start of a bone takes back its own joint's twist (-1, 0), the skin at its
        end goes along with the next joint's (0, 1).
    """

    bones: NDArray[np.int64]
    shares: FloatArray

    def __len__(self) -> int:
        """Return how many extra joints there are."""
        return len(self.bones)


def skinning_matrices(
    poses: NDArray[np.floating],
    trans: NDArray[np.floating],
    rest_joints: NDArray[np.floating],
    twist_joints: TwistJoints | None = None,
) -> NDArray[np.float32]:
    """Return the matrix by which each joint moves the skin from the rest pose.

    Parameters
    ----------
    poses : ndarray, shape (n, 55, 3)
        Rotations relative to the parent, axis-angle in radians.
    trans : ndarray, shape (n, 3)
        Translation in metres.
    rest_joints : ndarray, shape (55, 3) or (n, 55, 3)
        Joints of the unposed body in metres.
    twist_joints : TwistJoints or None
        Extra joints, K of them.

    Returns
    -------
    ndarray, shape (n, 55 + K, 3, 4), float32
        Applied to a point of the unposed skin with a 1 appended, gives where it is, in metres.
    """
    count = len(poses)
    turns = Rotation.from_rotvec(np.asarray(poses, float).reshape(-1, 3))
    rest = np.broadcast_to(rest_joints, (count, JOINT_COUNT, 3))
    local = turns.as_matrix().reshape(count, JOINT_COUNT, 3, 3)
    total = JOINT_COUNT + (len(twist_joints) if twist_joints is not None else 0)
    result = np.empty((count, total, 3, 4))
    world, moved = result[..., :3], result[..., 3]
    for joint, parent in enumerate(PARENTS):
        start = rest[:, joint]
        if parent < 0:
            world[:, joint] = local[:, joint]
            moved[:, joint] = start + trans - _turned(local[:, joint], start)
            continue
        world[:, joint] = world[:, parent] @ local[:, joint]
        place = _turned(world[:, parent], start) + moved[:, parent]
        moved[:, joint] = place - _turned(world[:, joint], start)
    if twist_joints is not None:
        _add_twist_joints(
            result, turns.as_quat().reshape(count, JOINT_COUNT, 4), rest, twist_joints
        )
    return result.astype(np.float32)


def twist_angles(
    quaternions: NDArray[np.floating], axes: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return by how much rotations twist about unit `axes`, in radians from -pi to pi.

    Parameters
    ----------
    quaternions : ndarray, shape (..., 4)
        Unit quaternions, scalar last.
    axes : ndarray, shape (..., 3)
        Unit vectors. A rotation by half a turn about an axis across has no twist: 0 is returned.
    """
    along = np.einsum("...a,...a->...", quaternions[..., :3], axes)
    scalar = quaternions[..., 3]
    sign = np.where(scalar < 0, -1.0, 1.0)
    return np.asarray(2 * np.arctan2(along * sign, np.abs(scalar)))


def _add_twist_joints(
    matrices: FloatArray, quaternions: FloatArray, rest: NDArray[np.floating], twist: TwistJoints
) -> None:
    """Fill in the matrices of the extra joints, which come last."""
    start, end = twist.bones.T
    axes = rest[:, end] - rest[:, start]
    axes = axes / np.linalg.norm(axes, axis=2, keepdims=True)
    angles = (
        twist.shares[:, 0] * twist_angles(quaternions[:, start], axes)
        + twist.shares[:, 1] * twist_angles(quaternions[:, end], axes)
    )  # fmt: skip
    about_bone = Rotation.from_rotvec((axes * angles[..., None]).reshape(-1, 3)).as_matrix()
    carrying = matrices[:, start]
    turned = carrying[..., :3] @ about_bone.reshape(*angles.shape, 3, 3)
    origin = rest[:, start]  # on the axis, so it stays where the carrying joint puts it
    place = _turned(carrying[..., :3], origin) + carrying[..., 3]
    matrices[:, JOINT_COUNT:, :, :3] = turned
    matrices[:, JOINT_COUNT:, :, 3] = place - _turned(turned, origin)


def _turned(matrices: FloatArray, points: NDArray[np.floating]) -> FloatArray:
    return np.asarray(np.einsum("...ab,...b->...a", matrices, points))
