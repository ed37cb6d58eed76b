"""From an ordinary video of somebody who talks to takes that networks are trained on."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from motion.audio import read_audio, write_wav
from motion.body.model import read_body
from motion.errors import InputError
from motion.files import harmless_cell, write_text
from motion.formats import write_clip
from motion.points.detection import Detection, Stretch, detect, stretches
from motion.points.found_motion import clip_from_detection
from motion.segment import check_name
from renderer.look import default_body
from training.data.found_take import usable_name

LEFT_OUT: Final = "left_out.csv"
"""In the folder of takes: which parts of which videos are no takes, and why."""

_COLUMNS: Final = ("video", "start", "end", "reason")
_NO_SOUND: Final = "no sound"
_WORTH_SAYING: Final = 0.1
"""Seconds by which a video may outlast its sound before anybody needs to know."""


@dataclass(frozen=True, kw_only=True)
class VideoTakes:
    """What became of a video.

    Attributes
    ----------
    takes : tuple of str
        Names of the takes.
    seconds : float
        How long they are together.
    notes : tuple of str
        What was left out or changed, for the researcher to read.
    """

    takes: tuple[str, ...]
    seconds: float
    notes: tuple[str, ...]


def import_video(
    video: Path, folder: Path, *, speaker: str | None, told: Callable[[int, int], None]
) -> VideoTakes:
    """Store each stretch of a video in which a person is seen as a take in a folder of takes.

    Nothing is written before everything has been found and checked.

    Parameters
    ----------
    video : Path
        Any video with sound.
    folder : Path
        Made where it is new; takes of other videos may be in it. A take is
        ``SPEAKER/VIDEO_01.npz`` and ``.wav``.
    speaker : str or None
        Who speaks; by default the video's name.
    told : callable
        Told how many frames have been looked at, of how many.

    Raises
    ------
    InputError
        If the video cannot be read, has no sound, shows nobody's face for long enough, or takes
        of such a name are there already.
    """
    if (folder / "study.toml").exists():
        raise InputError(
            "this is a study folder",
            where=folder,
            remedy="Give another folder for takes; 'import' brings single ones into a study",
        )
    speaker = usable_name(video.stem) if speaker is None else speaker
    check_name(speaker, "speaker")
    try:
        audio = read_audio(video, sample_rate=None)
    except InputError as error:
        raise InputError(
            error.what, where=video, remedy="Export the video with its sound as MP4 (H.264, AAC)"
        ) from error
    found = detect(video, told)
    parts = _parts(found, audio.duration)
    kept = [part for part in parts if not part.reason]
    if not kept:
        raise InputError(
            f"no part of the video can be used: {_reasons(parts)}",
            where=video,
            remedy="Give a video that shows one person's face and upper body for a while",
        )
    places = [
        folder / speaker / f"{usable_name(f'{video.stem}_{number:02d}')}.npz"
        for number in range(1, len(kept) + 1)
    ]
    for place in places:
        if place.exists():
            raise InputError(
                "a take of this name is there already",
                where=place,
                remedy="Rename the video, or remove its takes first",
            )
    body = read_body(default_body())
    clips = [
        clip_from_detection(found.stretch(part.start, part.end), body).with_provenance(
            source=video.name, format="video (MediaPipe)"
        )
        for part in kept
    ]
    rate = found.frame_rate
    for place, part, clip in zip(places, kept, clips, strict=True):
        sound = audio.cut(part.start / rate, part.end / rate)
        write_wav(place.with_suffix(".wav"), replace(sound, notes=()))
        write_clip(place, clip)
    left = [part for part in parts if part.reason]
    _add_left_out(folder / LEFT_OUT, video, left, rate)
    noted = [f"{place.stem}: {note}" for place, clip in zip(places, clips, strict=True)
             if (note := clip.provenance.get("notes"))]  # fmt: skip
    return VideoTakes(
        takes=tuple(place.stem for place in places),
        seconds=sum(clip.duration for clip in clips),
        notes=(
            *audio.notes,
            *(f"left out {part.start / rate:.1f} to {part.end / rate:.1f} s: {part.reason}"
              for part in left),
            *noted,
        ),
    )  # fmt: skip


def _parts(found: Detection, seconds: float) -> tuple[Stretch, ...]:
    """Return the parts of a video, the last of which may have no sound."""
    heard = min(len(found), int(seconds * found.frame_rate + 1e-6))
    parts = [
        replace(part, end=min(part.end, heard)) for part in stretches(found) if part.start < heard
    ]
    if len(found) - heard > _WORTH_SAYING * found.frame_rate:
        parts.append(Stretch(start=heard, end=len(found), reason=_NO_SOUND))
    return tuple(parts)


def _reasons(parts: Sequence[Stretch]) -> str:
    """Return why the parts are left out, those that take most frames first."""
    frames: dict[str, int] = {}
    for part in parts:
        frames[part.reason] = frames.get(part.reason, 0) + part.end - part.start
    total = max(sum(frames.values()), 1)
    ordered = sorted(frames.items(), key=lambda item: -item[1])
    return ", ".join(f"{reason} in {100 * count / total:.0f}%" for reason, count in ordered)


def _add_left_out(table: Path, video: Path, left: Sequence[Stretch], rate: float) -> None:
    """Add what was left out of a video to the table of the folder."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    if table.exists():
        text.write(table.read_text("utf-8"))
    else:
        writer.writerow(_COLUMNS)
    for part in left:
        times = (f"{frame / rate:.3f}" for frame in (part.start, part.end))
        writer.writerow((harmless_cell(video.name), *times, part.reason))
    write_text(table, text.getvalue())
