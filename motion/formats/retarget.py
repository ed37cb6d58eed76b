"""Retargeting the motion of another skeleton, with any rest pose, to the SMPL-X body.

Each SMPL-X joint has the world rotation of the source joint that it follows, corrected by a
constant rotation for the difference of the two rest poses. Spines of any length need no special
case, because world rotations include those of the joints below.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from types import MappingProxyType
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.body.skinning import NO_TWISTS, ForearmTwists, share_forearm_twist, twist_angles
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.bvh_motion import BvhMotion
from motion.formats.joint_maps import JointMap
from motion.points.turning import frame_rotations, smallest_rotations
from motion.skeleton import FINGER_NAMES, JOINT_NAMES, PARENTS, REST_JOINTS, joint_index

JointPositions = Mapping[str, Floats]

_SIDES: Final = ("left", "right")
_LIMBS: Final = (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle"))
_TRUNK: Final = ("pelvis", "spine1", "spine2", "spine3", "neck", "head")
_LEVEL: Final = 30.0
"""Tolerance for arms and trunk of a T-pose, in degrees."""

_UPRIGHT: Final = 60.0
"""Largest angle between trunk and legs of a standing rest pose, in degrees."""

_BUILD: Final = 15.0
"""Largest angle between trunk and axes, in degrees, that is attributed to how the skeleton was
built."""


def retarget(motion: BvhMotion, joint_map: JointMap) -> MotionClip:
    """Return the motion of a BVH skeleton as an SMPL-X clip, in the file's own world axes.

    Arms, legs and fingers point exactly where the source's bones point; trunk, head and feet
    turn from rest as the source's do. Elbow and wrist share the forearm's twist, unless the
    source's joints are SMPL-X's own. Translation is scaled by the ratio of leg lengths, so the
    file's length unit does not matter.

    Parameters
    ----------
    motion : BvhMotion
        The source; its rest pose must be a standing figure, arms in any direction.
    joint_map : mapping
        From SMPL-X joint names to source joint names.

    Raises
    ------
    InputError
        If the rest pose is not a standing figure.
    """
    return retarget_piece(motion, joint_map, None)[0]


def retarget_piece(
    motion: BvhMotion, joint_map: JointMap, previous: ForearmTwists | None
) -> tuple[MotionClip, ForearmTwists]:
    """Retarget one chunk of a motion; return it and the state for the next chunk.

    The chunks in order equal the whole motion, bit by bit.

    Parameters
    ----------
    motion, joint_map
        See `retarget`.
    previous : ForearmTwists or None
        The twists returned for the previous chunk; None for the first.
    """
    names = motion.joint_names
    rest = motion.rest_positions
    source = {joint: rest[names.index(name)] for joint, name in joint_map.items()}
    target = {joint: REST_JOINTS[joint_index(joint)] for joint in joint_map}
    corrections = dict(rest_corrections(source, target))
    corrections |= _trunk_corrections(motion, joint_map, corrections)
    positions, rotations = motion.forward_kinematics()
    world = np.empty((len(motion.values), len(JOINT_NAMES), 3, 3))
    local = np.empty_like(world)
    for index, (joint, parent) in enumerate(zip(JOINT_NAMES, PARENTS, strict=True)):
        if joint in joint_map:
            source_rotations = rotations[:, names.index(joint_map[joint])]
            world[:, index] = source_rotations @ corrections[joint].as_matrix()
        else:
            world[:, index] = world[:, parent]
        parent_rotation = world[:, parent] if parent >= 0 else np.eye(3)[None]
        local[:, index] = np.swapaxes(parent_rotation, 1, 2) @ world[:, index]
    shares = any(joint != name for joint, name in joint_map.items())
    twists = share_forearm_twist(local, previous) if shares else NO_TWISTS
    poses = Rotation.from_matrix(local.reshape(-1, 3, 3)).as_rotvec()
    scale = _limb_length(target) / _limb_length(source)
    clip = MotionClip(
        poses=poses.reshape(len(local), len(JOINT_NAMES), 3).astype(np.float32),
        trans=(positions[:, names.index(joint_map["pelvis"])] * scale).astype(np.float32),
        frame_rate=motion.frame_rate,
    )
    return clip, twists


def rest_corrections(source: JointPositions, target: JointPositions) -> Mapping[str, Rotation]:
    """Return the rotation from each SMPL-X joint's rest pose to the source's.

    Parameters
    ----------
    source, target : mapping of str to ndarray, shape (3,)
        Rest positions of the mapped joints in both skeletons, by SMPL-X name.

    Returns
    -------
    mapping of str to Rotation
        For every mapped joint. Trunk, head, collars and feet: the rotation of the whole figure.
        Limbs: in addition, the smallest rotations along the chain that give the bones the source's
        directions. Hands: a rotation to the source's palms, if there are fingers.
    """
    figure = _figure_rotation(source, target)
    corrections = dict.fromkeys(source, figure)
    for side in _SIDES:
        for limb in _LIMBS:
            chain = [f"{side}_{part}" for part in limb]
            last = _follow(chain, figure, source, target, corrections)
            if limb[-1] == "wrist":
                corrections[chain[-1]] = last
        wrist = f"{side}_wrist"
        hand = _hand_rotation(side, source, target) or corrections[wrist]
        corrections[wrist] = hand
        for finger in FINGER_NAMES:
            chain = [f"{side}_{finger}{number}" for number in (1, 2, 3)]
            last = _follow(chain, hand, source, target, corrections)
            if chain[-1] in source:
                corrections[chain[-1]] = last
    return MappingProxyType(corrections)


def _trunk_corrections(
    motion: BvhMotion, joint_map: JointMap, corrections: Mapping[str, Rotation]
) -> Mapping[str, Rotation]:
    """Return the corrections that make trunk and head straight in the calibration pose.

    Skeletons are built with straight necks, which the joints' values then bend. A person in a
    T-pose shows which values mean looking ahead.
    """
    if motion.calibration is None:
        return {}
    pose = replace(motion, values=motion.calibration[None])
    positions, rotations = (values[0] for values in pose.forward_kinematics())
    index = {joint: motion.joint_names.index(name) for joint, name in joint_map.items()}
    figure = corrections["pelvis"]
    up, left = figure.apply([0.0, 1.0, 0.0]), figure.apply([1.0, 0.0, 0.0])
    pelvis = Rotation.from_matrix(rotations[index["pelvis"]])
    heading = Rotation.from_rotvec(up * twist_angles(pelvis.as_quat(), up))
    for side, sign in zip(_SIDES, (1, -1), strict=True):
        arm = positions[index[f"{side}_wrist"]] - positions[index[f"{side}_shoulder"]]
        if arm @ heading.apply(left) * sign < np.cos(np.radians(_LEVEL)) * np.linalg.norm(arm):
            return {}
    straight = {
        joint: Rotation.from_matrix(rotations[index[joint]]).inv() * heading
        for joint in _TRUNK
        if joint in index
    }
    if max(np.degrees(turn.magnitude()) for turn in straight.values()) > _LEVEL:
        return {}
    return {joint: turn * figure for joint, turn in straight.items()}


def _follow(
    chain: list[str],
    turn: Rotation,
    source: JointPositions,
    target: JointPositions,
    corrections: dict[str, Rotation],
) -> Rotation:
    """Set the corrections along a chain of bones, starting from `turn`; return the last."""
    mapped = [joint for joint in chain if joint in source]
    for joint, child in pairwise(mapped):
        target_direction = source[child] - source[joint]
        current_direction = turn.apply(target[child] - target[joint])
        if np.linalg.norm(target_direction) > 0:
            turn = smallest_rotations(current_direction[None], target_direction[None])[0] * turn
        corrections[joint] = turn
    return turn


def _figure_rotation(source: JointPositions, target: JointPositions) -> Rotation:
    """Return the rotation of the whole figure between the rest poses.

    A figure whose axes are nearly the world's is treated as if they were: the lean of a skeleton's
    spine shows how the skeleton was built, not how the person stood.
    """
    up, left = _axes(source)
    if "left_ankle" in source:
        feet = (source["left_ankle"] + source["right_ankle"]) / 2
        legs = source["pelvis"] - feet
        if np.degrees(np.arctan2(np.linalg.norm(np.cross(legs, up)), legs @ up)) > _UPRIGHT:
            raise InputError(
                "the skeleton's rest pose (all rotations zero) is not a standing figure",
                remedy="Export the BVH with a T-pose or A-pose as its rest pose",
            )
    turn = frame_rotations(_axes(target), (up[None], left[None]))[0]
    along_axes = np.rint(turn.as_matrix())
    if np.array_equal(along_axes @ along_axes.T, np.eye(3)):
        nearest = Rotation.from_matrix(along_axes)
        if np.degrees((turn * nearest.inv()).magnitude()) < _BUILD:
            return nearest
    return turn


def _axes(places: JointPositions) -> tuple[Floats, Floats]:
    """Return the directions up the trunk and to the figure's left."""
    up = places["head"] - places["pelvis"]
    left = places["left_shoulder"] - places["right_shoulder"]
    if np.linalg.norm(np.cross(up, left)) == 0:
        raise InputError(
            "the skeleton's rest pose has no trunk and shoulders",
            remedy="Check the joint map and the offsets of the file",
        )
    return up, left


def _hand_rotation(side: str, source: JointPositions, target: JointPositions) -> Rotation | None:
    """Return the rotation of a hand, from its middle finger and palm; None without them."""
    wrist, middle, index, ring = (
        f"{side}_{part}" for part in ("wrist", "middle1", "index1", "ring1")
    )
    if not {wrist, middle, index, ring} <= set(source):
        return None
    hand, rest = (
        (places[middle] - places[wrist], places[index] - places[ring])
        for places in (source, target)
    )
    if any(np.linalg.norm(np.cross(*directions)) == 0 for directions in (hand, rest)):
        return None
    return frame_rotations(rest, (hand[0][None], hand[1][None]))[0]


def _limb_length(places: JointPositions) -> float:
    """Return the length of the left leg, or of the left arm if there is no leg."""
    limb = _LIMBS[1] if "left_ankle" in places else _LIMBS[0]
    joints = np.stack([places[f"left_{part}"] for part in limb])
    length = float(np.linalg.norm(np.diff(joints, axis=0), axis=1).sum())
    if length == 0:
        raise InputError("the skeleton's limbs have no length", remedy="Check the file's offsets")
    return length
