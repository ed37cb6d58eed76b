"""A motion clip prepared for display."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from motion.body.model import BodyModel
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.placement import stand_on_ground
from motion.resample import resample

LENGTH_TOLERANCE: Final = 0.1
"""Seconds by which motion and speech may differ; the last frame is repeated or left out."""


def as_shown(
    clip: MotionClip,
    body: BodyModel,
    path: Path,
    duration: float,
    frozen: tuple[str, ...],
    frame_rate: float,
) -> MotionClip:
    """Return `clip` as participants see it.

    It has the video's rate and length, frozen channels are still, and its feet stay on the ground.

    Parameters
    ----------
    clip : MotionClip
        The motion of one condition for one segment.
    body : BodyModel
        The body that stands on the ground.
    path : Path
        Where it comes from, for messages.
    duration : float
        Seconds of the segment's speech.
    frozen : tuple of str
        Channels to hold still, as `motion.clip.freeze` names them.
    frame_rate : float
        Frames per second to show it at.

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
    """Return the one frame of `clip` that is shown at `seconds`, as a clip of its own.

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
    # A moment given as the frame's own time must not fall to the frame before by rounding.
    index = min(int(seconds * clip.frame_rate + 1e-6), len(clip) - 1)
    return clip.frames(slice(index, index + 1))
