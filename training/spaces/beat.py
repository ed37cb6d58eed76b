"""BEAT's motion as DiffSHEG tells it: 47 joints' rotations and 51 facial weights a frame."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.body.forearm_twist import ForearmTwists
from motion.clip import ARKIT_COUNT, MotionClip
from motion.errors import InputError
from motion.face import ARKIT_NAMES
from motion.formats.bvh import BvhMotion
from motion.formats.bvh_hierarchy import BvhJoint
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget_piece
from motion.placement import place
from training.spaces.beat_skeleton import BEAT_SKELETON, TOLD_JOINTS

FloatArray = NDArray[np.float64]

FACIAL_WEIGHTS: Final = ARKIT_NAMES[:51]
"""BEAT records all of ARKit's but the last, the tongue, in ARKit's order."""

_BODY: Final = 3 * len(TOLD_JOINTS)


def body_values(motion: BvhMotion) -> FloatArray:
    """Return the rotations of the told joints of a BEAT recording, (T, 141) axis-angle in radians.

    Raises
    ------
    InputError
        If the skeleton lacks a joint.
    """
    names = motion.joint_names
    missing = [name for name in TOLD_JOINTS if name not in names]
    if missing:
        raise InputError(
            f"the skeleton is not BEAT's: it lacks {', '.join(missing[:5])}",
            remedy="Give a BVH file of BEAT",
        )
    turns = motion.local_rotations()[:, [names.index(name) for name in TOLD_JOINTS]]
    turned = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec()
    return np.asarray(turned.reshape(len(turns), _BODY))


def face_values(arkit: NDArray[np.float32]) -> FloatArray:
    """Return the facial weights that BEAT holds of `arkit` (T, 52), shape (T, 51)."""
    return arkit[:, : len(FACIAL_WEIGHTS)].astype(np.float64)


def told_motion(
    body: FloatArray, frame_rate: float, skeleton: tuple[BvhJoint, ...] = BEAT_SKELETON
) -> BvhMotion:
    """Return told rotations (T, 141) on a skeleton of BEAT; all other joints stay unturned.

    Parameters
    ----------
    body : ndarray, shape (T, 141)
        Axis-angle in radians, in the order of `TOLD_JOINTS`.
    frame_rate : float
        Frames per second.
    skeleton : tuple of BvhJoint
        A speaker's own, or the idealised one; joints turn about x, y and z in that order.
    """
    motion = BvhMotion(
        joints=skeleton,
        values=np.zeros((len(body), sum(len(joint.channels) for joint in skeleton))),
        frame_rate=frame_rate,
    )
    turns = body.reshape(len(body), len(TOLD_JOINTS), 3)
    for place_told, name in enumerate(TOLD_JOINTS):
        index = motion.joint_names.index(name)
        # Where several angles mean the same rotation, any will do.
        angles = Rotation.from_rotvec(turns[:, place_told]).as_euler(
            "XYZ", degrees=True, suppress_warnings=True
        )
        columns = motion.columns(index)
        motion.values[:, columns.stop - 3 : columns.stop] = angles
    return motion


def beat_clip(
    values: FloatArray, frame_rate: float, skeleton: tuple[BvhJoint, ...] = BEAT_SKELETON
) -> MotionClip:
    """Return DiffSHEG's motion as a clip of our body.

    Parameters
    ----------
    values : ndarray, shape (T, 192)
        Rotations of the 47 joints, axis-angle in radians, then 51 facial weights; weights outside
        [0, 1] are taken to the nearer end.
    frame_rate : float
        Frames per second.
    skeleton : tuple of BvhJoint
        See `told_motion`.

    Returns
    -------
    MotionClip
        Standing on the floor at the origin, facing +z; hips and legs stand still.
    """
    return beat_piece(values, frame_rate, None, skeleton)[0]


def beat_piece(
    values: FloatArray,
    frame_rate: float,
    before: ForearmTwists | None,
    skeleton: tuple[BvhJoint, ...] = BEAT_SKELETON,
) -> tuple[MotionClip, ForearmTwists]:
    """Return a piece of motion as `beat_clip` does, and what the next piece goes on from.

    The pieces of a motion one after the other are the motion as a whole, bit by bit.
    """
    motion = told_motion(values[:, :_BODY], frame_rate, skeleton)
    _, joint_map = choose_joint_map(motion.joint_names)
    moved, twists = retarget_piece(motion, joint_map, before)
    clip, _ = place(moved)
    arkit = np.zeros((len(values), ARKIT_COUNT), np.float32)
    arkit[:, : len(FACIAL_WEIGHTS)] = np.clip(values[:, _BODY:], 0, 1)
    made = MotionClip(poses=clip.poses, trans=clip.trans, frame_rate=frame_rate, arkit=arkit)
    return made, twists
