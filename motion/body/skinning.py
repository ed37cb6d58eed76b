"""Skinning of a posed body, with extra joints that distribute twists.

Linear blend skinning averages matrices. Where two joints differ by a large turn about the bone
between them, as elbow and wrist do when a palm turns up, the average shrinks and the skin is wrung
like a candy wrapper. Extra joints along the bone, turned by a growing share of that twist, leave
only small differences to average. Decomposition into swing and twist: Dobrowolski 2015,
"Swing-twist decomposition in Clifford algebra", section 3.

If a skeleton has all of a forearm's twist in the elbow or in the wrist, the two share it.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial.transform import Rotation

from motion.arrays import Floats, Floats32, Ints
from motion.skeleton import JOINT_COUNT, PARENTS, REST_JOINTS, joint_index

_SIDES: Final = ("left", "right")


@dataclass(frozen=True, kw_only=True, eq=False)
class TwistJoints:
    """Extra joints that turn about a bone; they come after the 55 of the skeleton.

    Each turns with the joint at which its bone starts, and also about the bone by a share of the
    twists of the joints at both ends.

    Attributes
    ----------
    bones : ndarray, shape (K, 2), int
        Start and end of the bone that each extra joint turns about.
    shares : ndarray, shape (K, 2), float64
        Shares of the twists of the joints at the start and at the end.
        The skin at the start of a bone takes back its own joint's twist (-1, 0), the skin at its
        end goes along with the next joint's (0, 1).
    """

    bones: Ints
    shares: Floats

    def __len__(self) -> int:
        """Return the number of extra joints."""
        return len(self.bones)


def skinning_matrices(
    poses: NDArray[np.floating],
    trans: NDArray[np.floating],
    rest_joints: NDArray[np.floating],
    twist_joints: TwistJoints | None = None,
) -> Floats32:
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
        Maps a point of the unposed skin, with a 1 appended, to its posed position in metres.
    """
    count = len(poses)
    turns = Rotation.from_rotvec(np.asarray(poses, float).reshape(-1, 3))
    rest = np.broadcast_to(rest_joints, (count, JOINT_COUNT, 3))
    local = turns.as_matrix().reshape(count, JOINT_COUNT, 3, 3)
    total = JOINT_COUNT + (len(twist_joints) if twist_joints is not None else 0)
    result = np.empty((count, total, 3, 4))
    world, translations = result[..., :3], result[..., 3]
    for joint, parent in enumerate(PARENTS):
        start = rest[:, joint]
        if parent < 0:
            world[:, joint] = local[:, joint]
            translations[:, joint] = start + trans - _rotate_points(local[:, joint], start)
            continue
        world[:, joint] = world[:, parent] @ local[:, joint]
        place = _rotate_points(world[:, parent], start) + translations[:, parent]
        translations[:, joint] = place - _rotate_points(world[:, joint], start)
    if twist_joints is not None:
        _add_twist_joints(
            result, turns.as_quat().reshape(count, JOINT_COUNT, 4), rest, twist_joints
        )
    return result.astype(np.float32)


def four_strongest(weights: sparse.csr_array) -> tuple[Ints, Floats32]:
    """Return each vertex's four joints with the largest weights, for graphics cards.

    Parameters
    ----------
    weights : sparse matrix, shape (V, J)
        Skin weights.

    Returns
    -------
    joints : ndarray, shape (V, 4), int64
        The strongest first.
    weights : ndarray, shape (V, 4), float32
        They sum to 1.
    """
    dense = weights.toarray()
    joints = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    strongest = np.take_along_axis(dense, joints, axis=1)
    strongest /= strongest.sum(axis=1, keepdims=True)
    return np.where(strongest > 0, joints, 0), strongest.astype(np.float32)


def twist_angles(quaternions: NDArray[np.floating], axes: NDArray[np.floating]) -> Floats:
    """Return the twist of rotations about unit `axes`, in radians from -pi to pi.

    Parameters
    ----------
    quaternions : ndarray, shape (..., 4)
        Unit quaternions, scalar last.
    axes : ndarray, shape (..., 3)
        Unit vectors. Half a turn about a perpendicular axis has no defined twist: 0 is returned.
    """
    projections = np.einsum("...a,...a->...", quaternions[..., :3], axes)
    scalar = quaternions[..., 3]
    sign = np.where(scalar < 0, -1.0, 1.0)
    return np.asarray(2 * np.arctan2(projections * sign, np.abs(scalar)))


def turns_about_bones(
    quaternions: NDArray[np.floating], rest_joints: NDArray[np.floating], twist: TwistJoints
) -> Floats:
    """Return the rotation of each extra joint relative to the one at its bone's start.

    Parameters
    ----------
    quaternions : ndarray, shape (n, 55, 4)
        Rotations relative to the parent, scalar last.
    rest_joints : ndarray, shape (55, 3) or (n, 55, 3)
        Joints of the unposed body in metres.
    twist : TwistJoints
        The extra joints, K of them.

    Returns
    -------
    ndarray, shape (n, K, 3)
        Axis-angle in radians.
    """
    start, end = twist.bones.T
    axes = rest_joints[..., end, :] - rest_joints[..., start, :]
    axes = axes / np.linalg.norm(axes, axis=-1, keepdims=True)
    axes = np.broadcast_to(axes, (len(quaternions), *axes.shape[-2:]))
    angles = (
        twist.shares[:, 0] * twist_angles(quaternions[:, start], axes)
        + twist.shares[:, 1] * twist_angles(quaternions[:, end], axes)
    )  # fmt: skip
    return np.asarray(axes * angles[..., None])


def _add_twist_joints(
    matrices: Floats, quaternions: Floats, rest: NDArray[np.floating], twist: TwistJoints
) -> None:
    """Fill in the matrices of the extra joints, which come last."""
    start = twist.bones[:, 0]
    turns = turns_about_bones(quaternions, rest, twist)
    about_bone = Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix()
    carrying = matrices[:, start]
    rotated = carrying[..., :3] @ about_bone.reshape(*turns.shape, 3)
    origin = rest[:, start]  # on the axis, so it stays where the carrying joint puts it
    place = _rotate_points(carrying[..., :3], origin) + carrying[..., 3]
    matrices[:, JOINT_COUNT:, :, :3] = rotated
    matrices[:, JOINT_COUNT:, :, 3] = place - _rotate_points(rotated, origin)


def _rotate_points(matrices: Floats, points: NDArray[np.floating]) -> Floats:
    return np.asarray(np.einsum("...ab,...b->...a", matrices, points))


@dataclass(frozen=True)
class ForearmTwists:
    """The twists of forearms in the last frame of a chunk of motion; the next chunk continues them.

    Attributes
    ----------
    angles : ndarray, shape (2, 2)
        Angles of the left and right arm's elbow and wrist, in radians from -pi to pi.
    turns : ndarray, shape (2, 2)
        Whole turns of each in addition.
    """

    angles: Floats
    turns: Floats


NO_TWISTS: Final = ForearmTwists(np.zeros((2, 2)), np.zeros((2, 2)))
"""Leaves forearms unchanged."""


def share_forearm_twist(local: Floats, previous: ForearmTwists | None) -> ForearmTwists:
    """Split each forearm's twist evenly between elbow and wrist; return the last frame's twists.

    Other skeletons often turn the palm at the elbow alone, which wrings the skin there. The
    directions of bones and hands do not change.

    Parameters
    ----------
    local : ndarray, shape (T, J, 3, 3)
        Rotation matrices of SMPL-X joints against their parents; those of elbows and wrists are
        overwritten.
    previous : ForearmTwists or None
        The result for the previous frames; None for the first.
    """
    last_twists = []
    for index, side in enumerate(_SIDES):
        elbow, wrist = joint_index(f"{side}_elbow"), joint_index(f"{side}_wrist")
        axis = REST_JOINTS[wrist] - REST_JOINTS[elbow]
        axis = axis / np.linalg.norm(axis)
        angles = np.column_stack(
            [
                twist_angles(Rotation.from_matrix(local[:, joint]).as_quat(), axis)
                for joint in (elbow, wrist)
            ]
        )
        turns = _turns(
            angles, None if previous is None else (previous.angles[index], previous.turns[index])
        )
        # An angle wraps past half a turn, where half of it would jump.
        twists = angles + 2 * np.pi * turns
        transferred = (twists[:, 0] - twists[:, 1]) / 2
        turn = Rotation.from_rotvec(transferred[:, None] * axis).as_matrix()
        local[:, elbow] = local[:, elbow] @ np.swapaxes(turn, 1, 2)
        local[:, wrist] = turn @ local[:, wrist]
        last_twists.append((angles[-1], turns[-1]))
    return ForearmTwists(*(np.stack(values) for values in zip(*last_twists, strict=True)))


def _turns(angles: Floats, previous: tuple[Floats, Floats] | None) -> Floats:
    """Return the whole turns to add to `angles` (T, n) so that they are continuous."""
    angle, turns = (angles[0], np.zeros(angles.shape[1])) if previous is None else previous
    steps = np.diff(angles, axis=0, prepend=angle[None])
    return np.asarray(turns - np.cumsum(np.round(steps / (2 * np.pi)), axis=0))
