"""Looking at a motion file without a study: a video, and a sheet of its frames."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image, ImageDraw

from motion.audio import Audio, read_audio
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.files import replacing
from motion.formats.joint_maps import JointMap
from motion.resample import cut
from renderer.clip_video import Stage, as_shown, still
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.figures.plate import INK, font
from renderer.framing import frame_clips
from renderer.look import Look, default_body
from renderer.loudness import at_common_loudness
from studyapp.stimuli.recorded_beside import read_recorded

_COLUMNS: Final = 4
_FRAMES: Final = 12
_CELL: Final = 360
"""Pixels along each side of a frame on the sheet."""


@dataclass(frozen=True, kw_only=True)
class Preview:
    """What a preview wrote, and what was changed on the way."""

    video: Path
    sheet: Path
    notes: tuple[str, ...]


def write_preview(
    motion: Path,
    out: Path,
    look: Look,
    *,
    speech: Path | None = None,
    frame_rate: float | None = None,
    joint_map: JointMap | None = None,
) -> Preview:
    """Show a motion file as a study would, by a camera that fits this motion.

    Parameters
    ----------
    motion : Path
        In any format that `motion.formats.read_motion` reads.
    out : Path
        The folder for ``NAME.mp4`` and ``NAME.png``.
    look : Look
        Body, size and framing.
    speech : Path, optional
        What is heard; where one of the two is longer, it is cut.
    frame_rate : float, optional
        Overrides what the file says of its frame rate.
    joint_map : mapping of str to str, optional
        For a BVH of an unknown skeleton.

    Raises
    ------
    InputError
        If motion or speech cannot be read.
    """
    clip, notes = read_recorded(motion, frame_rate=frame_rate, joint_map=joint_map)
    sound, seconds = _sound(speech, clip)
    body = default_body(look.avatar)
    model = read_body(body)
    clip = cut(clip, 0.0, seconds)
    shown = as_shown(clip, model, motion, clip.duration, (), look.frame_rate)
    preview = Preview(
        video=out / f"{motion.stem}.mp4", sheet=out / f"{motion.stem}.png", notes=tuple(notes)
    )
    with Stage(body, frame_clips([shown], model, look), look) as stage:
        with (
            replacing(preview.video) as draft,
            VideoWriter(draft, look.size, look.size, look.frame_rate, sound) as writer,
        ):
            for frame in stage.video_frames(shown):
                writer.write(frame)
        with replacing(preview.sheet) as draft:
            _sheet(stage, shown).save(draft, format="PNG")
    return preview


def _sound(speech: Path | None, clip: MotionClip) -> tuple[Audio, float]:
    """Return what is heard, silence without any speech, and how many seconds are shown."""
    if speech is None:
        silence = np.zeros(round(clip.duration * SOUND_RATE), np.float32)
        return Audio(silence, SOUND_RATE), clip.duration
    heard = read_audio(speech, sample_rate=SOUND_RATE)
    seconds = min(heard.duration, clip.duration)
    return at_common_loudness(heard.cut(0.0, seconds)), seconds


def _sheet(stage: Stage, clip: MotionClip) -> Image.Image:
    """Return frames spread evenly over `clip`, each with its time."""
    count = min(_FRAMES, len(clip))
    size = min(_CELL, stage.look.size)
    sheet = Image.new("RGB", (size * min(_COLUMNS, count), size * -(-count // _COLUMNS)), "white")
    draw = ImageDraw.Draw(sheet)
    for number in range(count):
        seconds = number * len(clip) // count / clip.frame_rate
        corner = (number % _COLUMNS * size, number // _COLUMNS * size)
        sheet.paste(still(stage, clip, seconds).resize((size, size)), corner)
        place = (corner[0] + size // 30, corner[1] + size // 30)
        draw.text(place, f"{seconds:.2f} s", font=font(size / 20), fill=INK)
    return sheet
