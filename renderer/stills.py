"""Single frames and contact sheets, to look at a motion without playing it."""

from __future__ import annotations

from collections.abc import Sequence

from PIL import Image

from motion.clip import MotionClip
from motion.errors import InputError
from renderer.clip_video import Stage
from renderer.frames import SUPERSAMPLING


def still(stage: Stage, clip: MotionClip, seconds: float) -> Image.Image:
    """Return the frame of `clip` that is shown at `seconds`, as RGB of the look's size."""
    frame = min(int(seconds * clip.frame_rate), len(clip) - 1)
    if seconds < 0 or seconds > clip.duration:
        raise InputError(
            f"there is no frame at {seconds:g} s of a motion of {clip.duration:.2f} s",
            remedy="Give a time within the motion",
        )
    picture = next(stage.pictures(clip.frames(slice(frame, frame + 1))))
    return Image.fromarray(picture[..., :3].copy()).reduce(SUPERSAMPLING)


def contact_sheet(
    stage: Stage, clips: Sequence[MotionClip], seconds: Sequence[float]
) -> Image.Image:
    """Return one picture with a row for each of `clips` and a column for each of `seconds`."""
    size = stage.look.size
    sheet = Image.new("RGB", (size * len(seconds), size * len(clips)))
    for row, clip in enumerate(clips):
        for column, moment in enumerate(seconds):
            sheet.paste(still(stage, clip, moment), (column * size, row * size))
    return sheet
