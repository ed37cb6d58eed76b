"""Rotations of the 55 joints from the motion of trunk, head and hands.

The trunk is posed first. The arms then reach, by inverse kinematics, for places that move with the
chest, and the legs keep the feet in place. The law of cosines determines the bend of a limb of two
bones. The remaining degree of freedom, the swivel of the elbow about the line from shoulder to
wrist (Tolani, Goswami & Badler 2000), is set by a pole: the direction in which the elbow points.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from generators.rule_based.vocabulary import Channel
from motion.arrays import Floats
from motion.skeleton import JOINT_COUNT, REST_JOINTS, forward_kinematics, joint_index

_STRAIGHTEST: Final = 0.999
_NEAREST: Final = 0.35


def solve(
    bones: tuple[Floats, Floats],
    root: Floats,
    target: Floats,
    pole: Floats,
    *,
    folds_toward: tuple[float, float, float],
    comfort: float,
) -> tuple[Floats, Floats]:
    """Return the rotations of two bones that put the limb's end at `target`.

    Parameters
    ----------
    bones : pair of ndarray, shape (3,)
        The upper and the lower bone in the rest pose, such as shoulder to elbow, elbow to wrist, in
        metres.
    root, target : ndarray, shape (T, 3)
        Positions of the limb's start and of the goal of its end, in metres.
    pole : ndarray, shape (T, 3)
        Direction in which the middle joint points; not along the limb.
    folds_toward : triple of float
        Direction of the wrist when only the elbow bends: forward for arms, backward for legs.
    comfort : float
        Share of the limb's length up to which it reaches exactly. Beyond it, the end lags behind
        smoothly, because a limb that snaps straight looks wrong.

    Returns
    -------
    upper, lower : ndarray, shape (T, 3, 3)
        World rotation matrices of the bones. The lower one is bent about the hinge only; its twist
        is left to the caller.
    """
    a, b = (float(np.linalg.norm(bone)) for bone in bones)
    line = target - root
    distance = np.linalg.norm(line, axis=-1, keepdims=True)
    direction = line / np.maximum(distance, 1e-9)
    span = _reachable_share(distance[..., 0] / (a + b), comfort) * (a + b)
    cosine = np.clip((a**2 + span**2 - b**2) / (2 * a * span), -1, 1)[..., None]
    side = pole - (pole * direction).sum(axis=-1, keepdims=True) * direction
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    upper = cosine * direction + np.sqrt(1 - cosine**2) * side
    lower = (span[..., None] * direction - a * upper) / b
    hinge = np.cross(side, direction)
    rest_hinge = np.cross(bones[0], folds_toward)
    rotations = (
        _frame(direction, hinge) @ np.swapaxes(_frame(bone, rest_hinge), -1, -2)
        for bone, direction in zip(bones, (upper, lower), strict=True)
    )
    return next(rotations), next(rotations)


def _reachable_share(share: Floats, comfort: float) -> Floats:
    """Return the share of the limb's length to span, eased near a straight limb."""
    margin = _STRAIGHTEST - comfort
    excess = np.maximum(share - comfort, 0)
    eased = np.minimum(share, comfort) + margin * np.tanh(excess / margin)
    return np.asarray(np.maximum(eased, _NEAREST))


def _frame(direction: Floats, hinge: Floats) -> Floats:
    x = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    z = np.cross(x, hinge)
    z /= np.linalg.norm(z, axis=-1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=-1)


_SIDES: Final = (("left", 1.0), ("right", -1.0))
_ELBOW_HANGS: Final = (0.45, -0.75, -0.6)
_KNEES_POINT: Final = (0.12, 0.0, 1.0)
_TWIST_IN_FOREARM: Final = 0.5
_LIFT_WITH_ARM: Final = 11.0
_LIFT_LEVEL: Final = 2.0
_ADVANCE_WITH_ARM: Final = 8.0
_SPINE: Final = ("spine1", "spine2", "spine3")
_NECK_SHARE: Final = 0.45

_FIST: Final = np.radians([78.0, 95.0, 60.0])
_THUMB_CURL: Final = np.radians([[14.0, 18.0, 0.0], [0.0, 28.0, 0.0], [0.0, 45.0, 0.0]])
_SPREAD_ANGLE: Final = np.radians([12.0, 1.0, -16.0, -8.0])
_THUMB_ABDUCTION: Final = np.radians(16.0)
_FINGERS: Final = ("index", "middle", "pinky", "ring")
_CURL_ORDER: Final = ("thumb", "index", "middle", "ring", "pinky")


@dataclass(frozen=True, kw_only=True, eq=False)
class Trunk:
    """The motion of everything but the arms and the face; by default one frame, upright.

    All turns have shape (T, 3), in degrees about x (nodding, forward positive), y (turning, to the
    body's left positive) and z (tilting, towards the body's right positive).

    Attributes
    ----------
    pelvis, spine, head : ndarray, shape (T, 3)
        Turns of the pelvis in the world, of the whole spine, and of neck and head together.
    shift : ndarray, shape (T, 3)
        Shift of the pelvis, in metres.
    shoulders_up, shoulders_forward : ndarray, shape (T,)
        Degrees of both collar bones.
    """

    pelvis: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    spine: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    head: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    shift: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    shoulders_up: Floats = field(default_factory=lambda: np.zeros(1))
    shoulders_forward: Floats = field(default_factory=lambda: np.zeros(1))


def pose_body(trunk: Trunk, hands: Mapping[str, Floats]) -> tuple[Floats, Floats]:
    """Return the joint rotations and the translation of a standing body.

    Parameters
    ----------
    trunk : Trunk
    hands : mapping of str to ndarray, shape (T, 13)
        Channels of `vocabulary.HandPose` for ``left`` and ``right``.

    Returns
    -------
    poses : ndarray, shape (T, 55, 3)
        Axis-angle in radians. Jaw and eyes are zero: facial actions move them, and a body that maps
        both would move them twice.
    trans : ndarray, shape (T, 3)
        Metres.
    """
    poses = np.zeros((len(trunk.shift), JOINT_COUNT, 3))
    poses[:, joint_index("pelvis")] = _rotvec(trunk.pelvis)
    for name in _SPINE:
        poses[:, joint_index(name)] = _rotvec(trunk.spine / len(_SPINE))
    poses[:, joint_index("neck")] = _rotvec(trunk.head * _NECK_SHARE)
    poses[:, joint_index("head")] = _rotvec(trunk.head * (1 - _NECK_SHARE))
    for side, sign in _SIDES:
        poses[:, joint_index(f"{side}_collar")] = _collar(trunk, hands[side], sign)
    joints, turns = forward_kinematics(poses, trunk.shift, REST_JOINTS)
    for side, sign in _SIDES:
        _pose_arm(poses, joints, turns, side, sign, hands[side])
        _pose_leg(poses, joints, turns, side, sign)
    return poses, trunk.shift


def _collar(trunk: Trunk, hand: Floats, sign: float) -> Floats:
    """Return the collar bone's turn, which rises and advances with its arm."""
    place = hand[:, Channel.PLACE] / np.linalg.norm(hand[:, Channel.PLACE], axis=1, keepdims=True)
    lift = trunk.shoulders_up + _LIFT_WITH_ARM * place[:, 1] + _LIFT_LEVEL
    advance = trunk.shoulders_forward + _ADVANCE_WITH_ARM * np.maximum(place[:, 2], 0) ** 2
    return _rotvec(np.column_stack([np.zeros(len(lift)), -sign * advance, sign * lift]))


def _pose_arm(
    poses: Floats, joints: Floats, turns: Floats, side: str, sign: float, hand: Floats
) -> None:
    """Write shoulder, elbow, wrist and fingers of one arm into `poses`."""
    shoulder, elbow, wrist = (joint_index(f"{side}_{j}") for j in ("shoulder", "elbow", "wrist"))
    bones = REST_JOINTS[elbow] - REST_JOINTS[shoulder], REST_JOINTS[wrist] - REST_JOINTS[elbow]
    length = sum(float(np.linalg.norm(bone)) for bone in bones)
    chest = turns[:, joint_index("spine3")]
    place = hand[:, Channel.PLACE] * (sign, 1.0, 1.0) * length
    swivel = np.radians(hand[:, Channel.ELBOW_OUT])
    outward, down, back = _ELBOW_HANGS
    pole = np.column_stack(
        [
            sign * (outward * np.cos(swivel) - down * np.sin(swivel)),
            down * np.cos(swivel) + outward * np.sin(swivel),
            np.full(len(swivel), back),
        ]
    )
    # Relative to the shoulder's position with the collar at rest, so that a shrug lifts the hand
    # less than the shoulder.
    spine3 = joint_index("spine3")
    socket = REST_JOINTS[shoulder] - REST_JOINTS[spine3]
    target = joints[:, spine3] + np.einsum("tij,tj->ti", chest, socket + place)
    pole = np.einsum("tij,tj->ti", chest, pole)
    upper, lower = solve(
        bones, joints[:, shoulder], target, pole, folds_toward=(0.0, 0.0, 1.0), comfort=0.93
    )
    collar = turns[:, joint_index(f"{side}_collar")]
    bend = np.swapaxes(upper, 1, 2) @ lower
    forearm = np.array([1.0, 0.0, 0.0])
    twist = np.radians(hand[:, Channel.PRONATION, None]) * forearm
    flex = np.radians(hand[:, Channel.FLEXION, None]) * (0.0, 0.0, -sign)
    deviate = np.radians(hand[:, Channel.DEVIATION, None]) * (0.0, -sign, 0.0)
    poses[:, shoulder] = _matrix_rotvec(np.swapaxes(collar, 1, 2) @ upper)
    in_forearm = Rotation.from_rotvec(twist * _TWIST_IN_FOREARM)
    poses[:, elbow] = (Rotation.from_matrix(bend) * in_forearm).as_rotvec()
    in_wrist = Rotation.from_rotvec(twist * (1 - _TWIST_IN_FOREARM))
    poses[:, wrist] = (in_wrist * Rotation.from_rotvec(flex + deviate)).as_rotvec()
    first = joint_index(f"{side}_index1")
    poses[:, first : first + 15] = _finger_rotations(hand, sign)


def _pose_leg(poses: Floats, joints: Floats, turns: Floats, side: str, sign: float) -> None:
    """Write hip, knee and ankle of one leg into `poses`, with the foot fixed."""
    hip, knee, ankle = (joint_index(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
    bones = REST_JOINTS[knee] - REST_JOINTS[hip], REST_JOINTS[ankle] - REST_JOINTS[knee]
    frames = len(poses)
    outward, up, forward = _KNEES_POINT
    pole = np.tile([sign * outward, up, forward], (frames, 1))
    foot = np.tile(REST_JOINTS[ankle], (frames, 1))
    upper, lower = solve(
        bones, joints[:, hip], foot, pole, folds_toward=(0.0, 0.0, -1.0), comfort=0.99
    )
    pelvis = turns[:, joint_index("pelvis")]
    poses[:, hip] = _matrix_rotvec(np.swapaxes(pelvis, 1, 2) @ upper)
    poses[:, knee] = _matrix_rotvec(np.swapaxes(upper, 1, 2) @ lower)
    poses[:, ankle] = _matrix_rotvec(np.swapaxes(lower, 1, 2))


def _finger_rotations(hand: Floats, sign: float) -> Floats:
    """Return the rotations of a hand's 15 joints, shape (T, 15, 3), in the skeleton's order."""
    rotations = np.zeros((len(hand), 15, 3))
    curls = hand[:, Channel.CURLS]
    for number, finger in enumerate(_FINGERS):
        curl = curls[:, _CURL_ORDER.index(finger)]
        joints = rotations[:, 3 * number : 3 * number + 3]
        joints[:, :, 2] = -sign * curl[:, None] * _FIST
        joints[:, 0, 1] = -sign * hand[:, Channel.SPREAD] * _SPREAD_ANGLE[number] * (1 - curl)
    thumb = curls[:, 0, None, None] * _THUMB_CURL
    thumb[:, 0, 1] -= _THUMB_ABDUCTION * hand[:, Channel.SPREAD]
    rotations[:, 12:15] = thumb * (1.0, sign, sign)
    return rotations


def _rotvec(turn: Floats) -> Floats:
    """Return turns in degrees, about y, then x, then z, as axis-angle, shape (T, 3)."""
    about_yxz = turn[:, [1, 0, 2]]
    return np.asarray(Rotation.from_euler("YXZ", about_yxz, degrees=True).as_rotvec())


def _matrix_rotvec(matrix: Floats) -> Floats:
    return np.asarray(Rotation.from_matrix(matrix).as_rotvec())
