"""Putting a motion into the study's world: y up, facing +z, feet on the floor at the origin.

Data sets disagree about which axis is up, which way a person faces and where they stand. None
of it is gesture, but all of it would show in a video and give a condition away. Many have no
translation: the pelvis stays in place while the legs move, and the feet hover or sink. A hand that
rests next to a slim person's leg, or on the hip, may be inside the leg or hip of another body: the
arm is turned about the shoulder until the hand is outside.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import correlate1d, maximum_filter1d
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.clip import MotionClip
from motion.skeleton import PARENTS, REST_JOINTS, forward_kinematics, joint_index

_STILL: Final = 1e-4
"""Range in metres of a height that counts as constant; less than any recording's noise."""

SINKS_AT_MOST: Final = 0.004
"""Largest depth of a sole below the ground, in metres."""

_SMOOTHED_OVER: Final = 0.1
"""Seconds before and after a frame over which its height is smoothed."""

_BEHIND_ANKLE: Final = 0.7
_BEFORE_TOES: Final = 1.0
"""Positions of heel and toes beyond ankle and foot joint, as shares of their distance."""

_SMALLEST_NOTED_TURN: Final = 1.0
"""Smallest turn that a note mentions, in degrees."""

_SIDES: Final = ("left", "right")


def stand_on_ground(clip: MotionClip, rest_joints: NDArray[np.floating]) -> MotionClip:
    """Return `clip` with its lower foot on the ground in every frame, if its height is constant.

    Parameters
    ----------
    clip : MotionClip
        The motion. If its height changes at all, it is returned unchanged.
    rest_joints : ndarray, shape (55, 3)
        Joints of the unposed body in the clip's shape, in metres.

    Returns
    -------
    MotionClip
        Only `trans` differs, and only in height. No sole is further below the ground than
        `SINKS_AT_MOST`. The height changes smoothly: soles may be a little above the ground while
        the legs move fast. Feet may still slide, since without translation the body's path is
        unknown.
    """
    if np.ptp(clip.trans[:, 1]) > _STILL:
        return clip
    lift = ground_height(rest_joints) - sole_heights(clip, rest_joints)
    trans = clip.trans.copy()
    trans[:, 1] += _smooth(lift, round(_SMOOTHED_OVER * clip.frame_rate))
    return replace(clip, trans=trans)


def ground_height(rest_joints: NDArray[np.floating]) -> float:
    """Return the height of the lower foot joint of the unposed body, in metres.

    The soles are below it by the joint's distance from the floor.
    """
    return float(min(rest_joints[joint_index(f"{side}_foot"), 1] for side in _SIDES))


def sole_heights(clip: MotionClip, rest_joints: NDArray[np.floating]) -> Floats:
    """Return the height of the lowest heel or toe in each frame, shape (T,), in metres.

    They are the ends of a flat plate at the height of the foot joint, which turns with the foot.
    """
    positions, rotations = forward_kinematics(clip.poses, clip.trans, rest_joints)
    heights = []
    for side in _SIDES:
        ankle, foot = joint_index(f"{side}_ankle"), joint_index(f"{side}_foot")
        foot_vector = rest_joints[foot] - rest_joints[ankle]
        heel = np.array([-_BEHIND_ANKLE, 1.0, -_BEHIND_ANKLE]) * foot_vector
        toes = np.array([_BEFORE_TOES, 0.0, _BEFORE_TOES]) * foot_vector
        for joint, offset in ((ankle, heel), (foot, toes)):
            heights.append((positions[:, joint] + rotations[:, joint] @ offset)[:, 1])
    return np.asarray(np.min(heights, axis=0))


def _hann_average(values: Floats, radius: int) -> Floats:
    """Return `values`, shape (T, …), averaged by a Hann window of `radius` frames to each side."""
    weights = np.hanning(2 * radius + 3)[1:-1]
    return np.asarray(correlate1d(values, weights / weights.sum(), axis=0, mode="nearest"))


def _smooth(lift: Floats, radius: int) -> Floats:
    """Return `lift` averaged over `radius` frames on each side, at most `SINKS_AT_MOST` below."""
    smooth = _hann_average(lift, radius)
    return np.maximum(smooth, lift - SINKS_AT_MOST)


def place(clip: MotionClip) -> tuple[MotionClip, tuple[str, ...]]:
    """Return `clip` placed in the study's world, and notes about its rotation.

    The axis nearest to the pelvis' mean up direction becomes +y, its mean facing direction becomes
    +z, and the mean position moves over the origin. The median height of the lower sole becomes the
    height of the floor, so that a single sunken frame does not lift all others. The motion itself
    does not change.
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
    if abs(heading) > _SMALLEST_NOTED_TURN:
        notes.append(f"turned by {-heading:.0f} degrees to face +z")
    return _stand_at_origin(clip), tuple(notes)


def _pelvis(clip: MotionClip) -> Rotation:
    return Rotation.from_rotvec(clip.poses[:, 0])


def _up_axis(clip: MotionClip) -> tuple[int, ...]:
    """Return the world axis nearest to the pelvis' mean up direction."""
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


_THIGH: Final = 0.085
_TRUNK: Final = 0.105
_TRUNK_ASIDE: Final = 0.065
"""Metres: the radius of a thigh, the radius of each of the trunk's two columns, and the distance of
the columns from the trunk's axis."""

_HAND: Final = {"wrist": 0.03, "middle1": 0.025, "middle3": 0.015, "index3": 0.01, "pinky3": 0.01}
"""Distance of the skin from each joint of the hand, in metres."""

_OUTWARD: Final = 0.05
"""Metres added to a hand's lateral position, so that it leaves a leg on the outside."""

_ROUNDS: Final = 3
_TURNS_SMOOTHED_OVER: Final = 0.15
"""Seconds on each side over which the size of an arm's turn is averaged; it fades over twice
that."""

_SMALLEST_NOTED_ARM_TURN: Final = np.radians(1.0)


def clear_of_body(clip: MotionClip) -> tuple[MotionClip, tuple[str, ...]]:
    """Return `clip` with its hands outside the default body, and a note where that changed it.

    Only the shoulders' rotations differ; elbow, wrist and fingers keep their bend. An arm does not
    change while its hand is outside and half a second before and after. A clip in which no arm
    would turn by a degree is returned unchanged.
    """
    recorded = clip
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for _ in range(_ROUNDS):
            turn = _smooth_turns(
                _outward_turns(clip, side, sign), round(_TURNS_SMOOTHED_OVER * clip.frame_rate)
            )
            if not turn.any():
                break
            clip = _rotate_arm(clip, joint_index(f"{side}_shoulder"), turn)
    angles = _arm_rotation_angles(recorded, clip)
    changed = angles > _SMALLEST_NOTED_ARM_TURN
    if not changed.any():
        return recorded, ()
    share, most = max(1, round(100 * changed.mean())), np.degrees(angles.max())
    return clip, (
        f"hands were moved out of trunk and thighs in {share}% of the frames, by up to {most:.0f} "
        "degrees at the shoulder (import --as-recorded leaves them)",
    )


def _arm_rotation_angles(before: MotionClip, after: MotionClip) -> Floats:
    """Return the larger of both arms' turns in each frame, in radians."""
    turns = []
    for side in ("left", "right"):
        joint = joint_index(f"{side}_shoulder")
        old, new = (Rotation.from_rotvec(clip.poses[:, joint]) for clip in (before, after))
        turns.append((old.inv() * new).magnitude())
    return np.asarray(np.max(turns, axis=0))


def _outward_turns(clip: MotionClip, side: str, sign: float) -> Floats:
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


def _columns(positions: Floats, rotations: Floats) -> list[tuple[Floats, Floats, float]]:
    """Return start and end, shape (T, 3), and radius of each column that hands must stay out of."""
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


def _nearest_point(point: Floats, start: Floats, end: Floats) -> Floats:
    """Return the point between `start` and `end` that is nearest to `point`, frame by frame."""
    segment = end - start
    share = ((point - start) * segment).sum(axis=1) / (segment**2).sum(axis=1)
    return np.asarray(start + np.clip(share, 0, 1)[:, None] * segment)


def _smooth_turns(turns: Floats, radius: int) -> Floats:
    """Return smoothed turns, at least as large as `turns` unless directions cancel.

    The maximum size within `radius`, averaged over `radius`, is at least the size itself. It
    spreads over twice `radius`, so directions are averaged over that.
    """
    size = np.linalg.norm(turns, axis=1)
    largest = maximum_filter1d(size, 2 * radius + 1, mode="nearest")
    smoothed, sizes = _hann_average(turns, 2 * radius), _hann_average(size, 2 * radius)
    share = _hann_average(largest, radius) / np.maximum(sizes, 1e-9)
    return np.asarray(smoothed * share[:, None])


def _rotate_arm(clip: MotionClip, shoulder: int, turn: Floats) -> MotionClip:
    """Return the clip with one shoulder turned further, in the world."""
    _, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    parent = Rotation.from_matrix(rotations[:, PARENTS[shoulder]])
    world = Rotation.from_rotvec(turn) * Rotation.from_matrix(rotations[:, shoulder])
    poses = clip.poses.copy()
    poses[:, shoulder] = (parent.inv() * world).as_rotvec()
    return replace(clip, poses=poses)
