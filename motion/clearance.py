"""Moving hands out of trunk and thighs, which they enter if a body has other proportions.

A hand that rests beside a slim person's leg, or on the hip, may lie inside the leg or the hip of
another body. The arm is turned about the shoulder until the hand is outside.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.placement import hann_average
from motion.skeleton import PARENTS, REST_JOINTS, forward_kinematics, joint_index

FloatArray = NDArray[np.float64]

_THIGH: Final = 0.085
_TRUNK: Final = 0.105
_TRUNK_ASIDE: Final = 0.065
"""Metres: radii of thighs and of the two columns, so far aside, that make up the trunk."""

_HAND: Final = {"wrist": 0.03, "middle1": 0.025, "middle3": 0.015, "index3": 0.01, "pinky3": 0.01}
"""Distance of the skin from each joint of the hand, in metres."""

_OUTWARD: Final = 0.05
"""Metres added to a hand's lateral position, so that it leaves a leg on its own side."""

_ROUNDS: Final = 3
_SMOOTHED_OVER: Final = 0.15
"""Seconds on each side over which the size of an arm's turn is averaged; it fades over twice
that."""

_SMALLEST_NOTED_TURN: Final = np.radians(1.0)


def clear_of_body(clip: MotionClip) -> tuple[MotionClip, tuple[str, ...]]:
    """Return `clip` with its hands outside the default body, and a note where that changed it.

    Only the shoulders' rotations differ; elbow, wrist and fingers keep their bend. An arm does not
    change while its hand is outside and half a second before and after. A clip in which no arm
    would turn by a degree is returned unchanged.
    """
    recorded = clip
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for _ in range(_ROUNDS):
            turn = _smooth(
                _outward_turns(clip, side, sign), round(_SMOOTHED_OVER * clip.frame_rate)
            )
            if not turn.any():
                break
            clip = _rotate_arm(clip, joint_index(f"{side}_shoulder"), turn)
    angles = _arm_rotation_angles(recorded, clip)
    changed = angles > _SMALLEST_NOTED_TURN
    if not changed.any():
        return recorded, ()
    share, most = max(1, round(100 * changed.mean())), np.degrees(angles.max())
    return clip, (
        f"hands were moved out of trunk and thighs in {share}% of the frames, by up to {most:.0f} "
        "degrees at the shoulder (import --as-recorded leaves them)",
    )


def _arm_rotation_angles(before: MotionClip, after: MotionClip) -> FloatArray:
    """Return the larger of both arms' turns in each frame, in radians."""
    turns = []
    for side in ("left", "right"):
        joint = joint_index(f"{side}_shoulder")
        old, new = (Rotation.from_rotvec(clip.poses[:, joint]) for clip in (before, after))
        turns.append((old.inv() * new).magnitude())
    return np.asarray(np.max(turns, axis=0))


def _outward_turns(clip: MotionClip, side: str, sign: float) -> FloatArray:
    """Return the axis-angle turn in the world that moves each frame's hand out, shape (T, 3)."""
    positions, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    outward = sign * rotations[:, 0, :, 0]
    shoulder = positions[:, joint_index(f"{side}_shoulder")]
    best = np.zeros((len(clip), 3))
    deepest = np.zeros(len(clip))
    for name, thickness in _HAND.items():
        point = positions[:, joint_index(f"{side}_{name}")]
        for start, end, radius in _columns(positions, rotations):
            offset = point - _nearest_point(point, start, end) + _OUTWARD * outward
            distance = np.linalg.norm(offset, axis=1)
            depth = radius + thickness - np.linalg.norm(offset - _OUTWARD * outward, axis=1)
            push = offset / np.maximum(distance, 1e-6)[:, None] * np.maximum(depth, 0)[:, None]
            arm = point - shoulder
            turn = np.cross(arm, push) / (arm**2).sum(axis=1)[:, None]
            deeper = depth > deepest
            best[deeper], deepest[deeper] = turn[deeper], depth[deeper]
    return best


def _columns(
    positions: FloatArray, rotations: FloatArray
) -> list[tuple[FloatArray, FloatArray, float]]:
    """Return start and end, shape (T, 3), and radius of what hands must stay out of."""
    pelvis, chest = positions[:, joint_index("pelvis")], positions[:, joint_index("spine3")]
    aside = _TRUNK_ASIDE * rotations[:, 0, :, 0]
    hips = [
        (positions[:, joint_index(f"{s}_hip")], positions[:, joint_index(f"{s}_knee")])
        for s in ("left", "right")
    ]
    return [
        *((hip, knee, _THIGH) for hip, knee in hips),
        *((pelvis + shift, chest + shift, _TRUNK) for shift in (aside, -aside)),
    ]


def _nearest_point(point: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the point between `start` and `end` that is nearest to `point`, frame by frame."""
    segment = end - start
    share = ((point - start) * segment).sum(axis=1) / (segment**2).sum(axis=1)
    return np.asarray(start + np.clip(share, 0, 1)[:, None] * segment)


def _smooth(turns: FloatArray, radius: int) -> FloatArray:
    """Return smooth turns that, unless directions cancel, are at least as large as the given ones.

    The largest size within reach, averaged within reach, is at least the size itself. Directions
    are averaged over twice the reach, which is as far as that spreads.
    """
    size = np.linalg.norm(turns, axis=1)
    largest = maximum_filter1d(size, 2 * radius + 1, mode="nearest")
    smoothed, sizes = hann_average(turns, 2 * radius), hann_average(size, 2 * radius)
    share = hann_average(largest, radius) / np.maximum(sizes, 1e-9)
    return np.asarray(smoothed * share[:, None])


def _rotate_arm(clip: MotionClip, shoulder: int, turn: FloatArray) -> MotionClip:
    """Return the clip with one shoulder turned further, in the world."""
    _, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    parent = Rotation.from_matrix(rotations[:, PARENTS[shoulder]])
    world = Rotation.from_rotvec(turn) * Rotation.from_matrix(rotations[:, shoulder])
    poses = clip.poses.copy()
    poses[:, shoulder] = (parent.inv() * world).as_rotvec()
    return replace(clip, poses=poses)
