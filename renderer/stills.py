"""Single frames, to look at a motion without playing it."""

from __future__ import annotations

from PIL import Image

from motion.clip import MotionClip
from motion.errors import InputError
from renderer.clip_video import Stage
from renderer.frames import SUPERSAMPLING


def still(stage: Stage, clip: MotionClip, seconds: float) -> Image.Image:
    """Return the frame of `clip` that is shown at `seconds`, as RGB of the look's size."""
    return large_still(stage, frame_at(clip, seconds)).reduce(SUPERSAMPLING)


def large_still(stage: Stage, pose: MotionClip) -> Image.Image:
    """Return the first frame of `pose` as RGB, `SUPERSAMPLING` times the look's size."""
    picture = next(stage.pictures(pose))
    return Image.fromarray(picture[..., :3].copy())


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
