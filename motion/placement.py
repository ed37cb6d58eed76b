"""Putting a motion into the study's world: y up, facing +z, feet on the floor at the origin.

Data sets disagree about which axis is up, which way a person faces and where they stand. None
of it is gesture, but all of it would show in a video and give a condition away.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.ground import ground_height, sole_heights
from motion.rest_pose import REST_JOINTS

_TURN_WORTH_SAYING: Final = 1.0
"""Degrees of turning up to which nobody needs to know."""


def place(clip: MotionClip) -> tuple[MotionClip, tuple[str, ...]]:
    """Return `clip` placed in the study's world, and notes about what was turned.

    The axis nearest to the pelvis' mean direction up becomes +y, the mean direction the pelvis
    faces becomes +z, the mean position comes to lie over the origin, and the lower foot, for half
    of the time, on the floor of the unposed body: a single frame in which a recording sinks does
    not lift all others. The motion itself is not changed.
    """
    notes: list[str] = []
    axis = _up_axis(clip)
    if axis != (0, 1, 0):
        clip = _turn_world(clip, _to_y_up(axis))
        letter = "xyz"[int(np.argmax(np.abs(axis)))]
        notes.append(f"{'-' if sum(axis) < 0 else ''}{letter} was up; turned to y up")
    facing = _pelvis(clip).apply([0, 0, 1]).mean(axis=0)
    heading = float(np.degrees(np.arctan2(facing[0], facing[2])))
    clip = _turn_world(clip, Rotation.from_euler("y", -heading, degrees=True))
    if abs(heading) > _TURN_WORTH_SAYING:
        notes.append(f"turned by {-heading:.0f} degrees to face +z")
    return _stand_at_origin(clip), tuple(notes)


def _pelvis(clip: MotionClip) -> Rotation:
    return Rotation.from_rotvec(clip.poses[:, 0])


def _up_axis(clip: MotionClip) -> tuple[int, ...]:
    """Return the world axis nearest to where the top of the pelvis points on average."""
    up = _pelvis(clip).apply([0, 1, 0]).mean(axis=0)
    nearest = int(np.argmax(np.abs(up)))
    return tuple(int(np.sign(up[k])) if k == nearest else 0 for k in range(3))


def _to_y_up(axis: tuple[int, ...]) -> Rotation:
    """Return the turn about a horizontal axis that takes `axis` to +y."""
    x, y, z = axis
    return Rotation.from_euler("xz", [-90 * z + 180 * (y < 0), 90 * x], degrees=True)


def _turn_world(clip: MotionClip, turn: Rotation) -> MotionClip:
    poses = clip.poses.copy()
    poses[:, 0] = (turn * _pelvis(clip)).as_rotvec()
    return replace(clip, poses=poses, trans=turn.apply(clip.trans).astype(np.float32))


def _stand_at_origin(clip: MotionClip) -> MotionClip:
    shift = np.zeros(3)
    shift[[0, 2]] = -clip.trans[:, [0, 2]].mean(axis=0)
    shift[1] = ground_height(REST_JOINTS) - float(np.median(sole_heights(clip, REST_JOINTS)))
    return replace(clip, trans=(clip.trans + shift).astype(np.float32))
