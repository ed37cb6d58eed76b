"""A motion clip prepared for display."""

from pathlib import Path
from typing import Final

import numpy as np

from motion.body.model import BodyModel
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.placement import stand_on_ground
from motion.resample import resample

LENGTH_TOLERANCE: Final = 0.1
"""Seconds by which motion and speech may differ; the motion is cut, or its last frame repeated."""


def as_shown(
    clip: MotionClip,
    body: BodyModel,
    path: Path,
    duration: float,
    frozen: tuple[str, ...],
    frame_rate: float,
) -> MotionClip:
    """Return `clip` as participants see it.

    It has the video's frame rate and length, frozen channels, and its feet on the ground.

    Parameters
    ----------
    clip : MotionClip
        The motion of one condition for one segment.
    body : BodyModel
        The body that shows the motion.
    path : Path
        The file of the motion, for messages.
    duration : float
        Duration of the segment's speech in seconds.
    frozen : tuple of str
        Channels to hold still, see `motion.clip.freeze`.
    frame_rate : float
        Frames per second of the video.

    Returns
    -------
    MotionClip
        ``max(1, round(duration * frame_rate))`` frames.

    Raises
    ------
    InputError
        If motion and speech differ in length by more than `LENGTH_TOLERANCE`.
    """
    if abs(clip.duration - duration) > LENGTH_TOLERANCE:
        raise InputError(
            f"the motion lasts {clip.duration:.2f} s, its speech {duration:.2f} s",
            where=path,
            remedy="Cut both to the same length",
        )
    result = freeze(resample(clip, frame_rate), frozen)
    result = stand_on_ground(result, body.joints(clip.betas))
    count = max(1, round(duration * frame_rate))
    return result.frames(np.minimum(np.arange(count), len(result) - 1))


def frame_at(clip: MotionClip, seconds: float) -> MotionClip:
    """Return the frame of `clip` that is shown at `seconds`, as a clip of one frame.

    Raises
    ------
    InputError
        If `seconds` is not within the clip.
    """
    if not 0 <= seconds <= clip.duration:
        raise InputError(
            f"there is no frame at {seconds:g} s of a motion of {clip.duration:.2f} s",
            remedy=f"Give a time from 0 to {clip.duration:.2f} s",
        )
    # A frame's own time must not be rounded down to the previous frame.
    index = min(int(seconds * clip.frame_rate + 1e-6), len(clip) - 1)
    return clip.frames(slice(index, index + 1))
