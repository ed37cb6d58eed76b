"""A motion clip as BVH: its joints and where they go, without face and skin."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.formats.bvh_motion import BvhJoint, BvhMotion, write_bvh
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, PARENTS

_ORDER: Final = "ZXY"
_TURNS: Final = tuple(f"{axis}rotation" for axis in _ORDER)
_ROOT: Final = ("Xposition", "Yposition", "Zposition", *_TURNS)
_CENTIMETRES: Final = 100.0


def write_clip_bvh(path: Path, clip: MotionClip, rest_joints: NDArray[np.floating]) -> None:
    """Write the joints of `clip` to `path`, in one step.

    Joints have SMPL-X's names; lengths are centimetres, as in recordings.

    Parameters
    ----------
    path : Path
        The file; missing folders are made.
    clip : MotionClip
        The motion.
    rest_joints : ndarray, shape (55, 3)
        Joints of the unposed body in metres, as `motion.body.model.BodyModel.joints` gives them.
    """
    offsets = np.array(rest_joints, float) * _CENTIMETRES
    root = offsets[0] + clip.trans * _CENTIMETRES
    offsets[1:] -= offsets[list(PARENTS[1:])]
    offsets[0] = 0  # programs differ in whether the root's positions are added to its offset
    joints = tuple(
        BvhJoint(
            name=name,
            parent=parent,
            offset=(float(offset[0]), float(offset[1]), float(offset[2])),
            channels=_ROOT if parent < 0 else _TURNS,
        )
        for name, parent, offset in zip(JOINT_NAMES, PARENTS, offsets, strict=True)
    )
    turns = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float))
    angles = turns.as_euler(_ORDER, degrees=True, suppress_warnings=True)
    # Programs that draw between frames must not see an angle jump from 180 to -180 degrees.
    angles = np.unwrap(angles.reshape(len(clip), JOINT_COUNT * 3), axis=0, period=360)
    values = np.concatenate([root, angles], axis=1)
    write_bvh(path, BvhMotion(joints=joints, values=values, frame_rate=clip.frame_rate))
