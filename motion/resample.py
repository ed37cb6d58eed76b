"""Changing a clip's frame rate, and cutting an excerpt out of it."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.arrays import Floats, Floats32
from motion.clip import MotionClip, check_frame_rate
from motion.segment import excerpt_bounds


def resample(clip: MotionClip, frame_rate: float) -> MotionClip:
    """Return `clip` at another frame rate, over the same time.

    Rotations are interpolated on the sphere (slerp), everything else linearly. New frame k lies
    at ``k / frame_rate`` seconds; frames past the clip's last one repeat it. Nothing is filtered:
    a recorded wrist moves by less than 0.4 mm (root mean square) at frequencies above 15 Hz, half
    the videos' rate; that is a fraction of a pixel.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    frame_rate : float
        Frames per second of the result, from 1 to 1000.

    Returns
    -------
    MotionClip
        ``round(clip.duration * frame_rate)`` frames, at least one.

    Raises
    ------
    InputError
        If `frame_rate` is out of range.
    """
    check_frame_rate(frame_rate)
    if frame_rate == clip.frame_rate:
        return clip
    previous, following, share = frame_positions(len(clip), clip.frame_rate, frame_rate)
    weight = share.astype(np.float32)[:, None]
    linear: dict[str, Any] = {
        name: (1 - weight) * values[previous] + weight * values[following]
        for name, values in {"trans": clip.trans, **clip.faces}.items()
    }
    poses = slerp(clip.poses[previous], clip.poses[following], share)
    return replace(clip, frame_rate=frame_rate, poses=poses, **linear)


def frame_positions(
    frames: int, given_rate: float, frame_rate: float
) -> tuple[NDArray[np.int_], NDArray[np.int_], Floats]:
    """Return the source frames around each frame at another rate.

    Parameters
    ----------
    frames : int
        Number of source frames, at least 1.
    given_rate, frame_rate : float
        Frames per second of the source and of the result.

    Returns
    -------
    before, after : ndarray of int, shape (n,)
        The source frames on either side; ``n = round(frames / given_rate * frame_rate)``, at least
        1.
    share : ndarray, shape (n,)
        How far from `before` to `after` each new frame lies, in [0, 1).
    """
    count = max(1, round(frames / given_rate * frame_rate))
    # Rounding keeps frames that fall on a source frame exactly there.
    position = np.round(np.arange(count) * given_rate / frame_rate, 9)
    previous = position.astype(int)
    following = np.minimum(previous + 1, frames - 1)
    return previous, following, position - previous


def slerp(first: Floats32, second: Floats32, share: Floats) -> Floats32:
    """Return the rotation vectors `share` of the way along the shortest turn.

    Parameters
    ----------
    first, second : ndarray, shape (T, joints, 3)
        Axis-angle in radians.
    share : ndarray, shape (T,)
        In [0, 1].
    """
    is_between = share > 0
    result = first.copy()
    start = Rotation.from_rotvec(first[is_between].reshape(-1, 3))
    turn = (start.inv() * Rotation.from_rotvec(second[is_between].reshape(-1, 3))).as_rotvec()
    joints = first.shape[1]
    partial = Rotation.from_rotvec(turn * np.repeat(share[is_between], joints)[:, None])
    result[is_between] = (start * partial).as_rotvec().reshape(-1, joints, 3)
    return result


def cut(clip: MotionClip, start: float, end: float) -> MotionClip:
    """Return the excerpt of `clip` from `start` to `end`.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    start, end : float
        Seconds, ``0 <= start < end``. If `end` is past the clip by no more than
        `motion.segment.CUT_TOLERANCE`, the last frame is held.

    Returns
    -------
    MotionClip
        Exactly ``round((end - start) * clip.frame_rate)`` frames.

    Raises
    ------
    InputError
        If the excerpt is empty or lies outside the clip.
    """
    first, count = excerpt_bounds(start, end, rate=clip.frame_rate, length=len(clip))
    return clip.frames(np.minimum(np.arange(first, first + count), len(clip) - 1))
