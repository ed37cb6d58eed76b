"""BEAT's motion as DiffSHEG represents it: 47 joint rotations and 51 facial weights per frame.

Rotations refer to an idealised figure. Every speaker of BEAT has their own skeleton, but all have
the same joints and the same rest pose: upright, arms level, palms down, facing +z, centimetres.
Bones have round lengths, see ``beat_skeleton.toml``; only their directions matter, since motion is
retargeted to another body anyway.
"""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.arrays import Floats, Floats32
from motion.body.skinning import ForearmTwists
from motion.clip import ARKIT_COUNT, ARKIT_NAMES, MotionClip
from motion.errors import InputError
from motion.formats.bvh_motion import BvhJoint, BvhMotion
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget_piece
from motion.placement import place

Offset = tuple[float, float, float]

_TURNS: Final = ("Xrotation", "Yrotation", "Zrotation")
_ROOT: Final = ("Xposition", "Yposition", "Zposition", *_TURNS)

_PARTS: Final = tomllib.loads(Path(__file__).with_name("beat_skeleton.toml").read_text("utf-8"))

_MODELLED_TRUNK: Final = ("Spine", "Neck", "Neck1")

UPPER_BODY_JOINTS: Final = (
    *_MODELLED_TRUNK,
    *(
        f"{side}{name}"
        for side in ("Right", "Left")
        for name, *_ in _PARTS["arm"]
        if not name.endswith("4")
    ),
)
"""The 47 joints of DiffSHEG's rotations, in its order. BEAT's prepared files lack the others: limb
ends, hips and legs stand still, and the whole spine bends in its lowest joint."""


def _joints() -> Iterator[tuple[str, str, Offset]]:
    for name, parent, (x, y, z) in _PARTS["trunk"]:
        yield name, parent, (x, y, z)
    for part in (_PARTS["arm"], _PARTS["leg"]):
        names = {name for name, *_ in part}
        for side, sign in (("Right", -1), ("Left", 1)):
            for name, parent, (x, y, z) in part:
                parent_name = f"{side}{parent}" if parent in names else parent
                yield f"{side}{name}", parent_name, (sign * x, y, z)


def _skeleton() -> tuple[BvhJoint, ...]:
    joints = [BvhJoint(name="Hips", parent=-1, offset=(0, 0, 0), channels=_ROOT)]
    places = {"Hips": 0}
    for name, parent, offset in _joints():
        joints.append(BvhJoint(name=name, parent=places[parent], offset=offset, channels=_TURNS))
        places[name] = len(places)
    return tuple(joints)


BEAT_SKELETON: Final = _skeleton()
"""The 75 joints of BEAT's files on the idealised figure, root first; offsets in centimetres."""


FACIAL_WEIGHTS: Final = ARKIT_NAMES[:51]
"""BEAT's facial actions: all of ARKit's but the last, the tongue, in ARKit's order."""

_BODY: Final = 3 * len(UPPER_BODY_JOINTS)


def body_values(motion: BvhMotion) -> Floats:
    """Return the rotations of a BEAT recording's 47 joints, (T, 141) axis-angle in radians.

    Raises
    ------
    InputError
        If the skeleton lacks a joint.
    """
    names = motion.joint_names
    missing = [name for name in UPPER_BODY_JOINTS if name not in names]
    if missing:
        raise InputError(
            f"the skeleton is not BEAT's: it lacks {', '.join(missing[:5])}",
            remedy="Give a BVH file of BEAT",
        )
    turns = motion.local_rotations()[:, [names.index(name) for name in UPPER_BODY_JOINTS]]
    rotation_vectors = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec()
    return np.asarray(rotation_vectors.reshape(len(turns), _BODY))


def face_values(arkit: Floats32) -> Floats:
    """Return BEAT's facial weights (T, 51) of `arkit` (T, 52)."""
    return arkit[:, : len(FACIAL_WEIGHTS)].astype(np.float64)


def upper_body_motion(body: Floats, frame_rate: float) -> BvhMotion:
    """Return rotations (T, 141) on the idealised figure; all other joints are at rest.

    Parameters
    ----------
    body : ndarray, shape (T, 141)
        Axis-angle in radians, in the order of `UPPER_BODY_JOINTS`.
    frame_rate : float
        Frames per second.
    """
    motion = BvhMotion(
        joints=BEAT_SKELETON,
        values=np.zeros((len(body), sum(len(joint.channels) for joint in BEAT_SKELETON))),
        frame_rate=frame_rate,
    )
    turns = body.reshape(len(body), len(UPPER_BODY_JOINTS), 3)
    for row, name in enumerate(UPPER_BODY_JOINTS):
        index = motion.joint_names.index(name)
        # If several angles give the same rotation, any will do.
        angles = Rotation.from_rotvec(turns[:, row]).as_euler(
            "XYZ", degrees=True, suppress_warnings=True
        )
        columns = motion.columns(index)
        motion.values[:, columns.stop - 3 : columns.stop] = angles
    return motion


def beat_clip(values: Floats, frame_rate: float) -> MotionClip:
    """Return DiffSHEG's motion as a clip of our body.

    Parameters
    ----------
    values : ndarray, shape (T, 192)
        Rotations of the 47 joints, axis-angle in radians, then 51 facial weights, which are clipped
        to [0, 1].
    frame_rate : float
        Frames per second.

    Returns
    -------
    MotionClip
        Standing on the floor at the origin, facing +z; hips and legs stand still.
    """
    return beat_clip_piece(values, frame_rate, None)[0]


def beat_clip_piece(
    values: Floats, frame_rate: float, previous: ForearmTwists | None
) -> tuple[MotionClip, ForearmTwists]:
    """Convert one chunk of motion as `beat_clip` does; return it and the state for the next chunk.

    The chunks in order equal the whole motion, bit by bit.
    """
    motion = upper_body_motion(values[:, :_BODY], frame_rate)
    _, joint_map = choose_joint_map(motion.joint_names)
    retargeted, twists = retarget_piece(motion, joint_map, previous)
    clip, _ = place(retargeted)
    arkit = np.zeros((len(values), ARKIT_COUNT), np.float32)
    arkit[:, : len(FACIAL_WEIGHTS)] = np.clip(values[:, _BODY:], 0, 1)
    chunk = MotionClip(poses=clip.poses, trans=clip.trans, frame_rate=frame_rate, arkit=arkit)
    return chunk, twists
