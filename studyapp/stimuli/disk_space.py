"""Whether the disk holds what a rendering will write, found before it begins."""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.look import Look
from studyapp.study.media import ClipVideo, PairVideo

FRAMES_LIMIT: Final = 20 * 10**9
"""Bytes of frames that are kept where nobody says otherwise and the disk has room."""

# Bytes per frame and pixel of one clip's picture: twice what a gesturing upper body takes.
_FRAMES: Final = 0.07
_CLIP: Final = 0.02
_PAIR: Final = 0.03
_SOUND: Final = 20_000
"""Bytes per second of what is heard, with what holds it together."""

_UNITS: Final = ((10**9, "GB"), (10**6, "MB"))


def frames_limit(folder: Path, kept: int) -> int:
    """Return how many bytes of frames may stay: `FRAMES_LIMIT`, or half of the room there is.

    Parameters
    ----------
    folder : Path
        A folder on the disk in question.
    kept : int
        Bytes of frames that are there already.
    """
    return min(FRAMES_LIMIT, (shutil.disk_usage(folder).free + kept) // 2)


def check_room(
    folder: Path,
    to_do: Iterable[ClipVideo | PairVideo],
    look: Look,
    *,
    sides: Collection[tuple[str, str]],
    limit: int,
    kept: int,
) -> None:
    """Refuse to begin where the disk would be full before the end.

    Parameters
    ----------
    folder : Path
        The study's folder.
    to_do : iterable of ClipVideo and PairVideo
        Videos to be made; those that they replace give their room back.
    look : Look
        Size and frame rate of the videos.
    sides : collection of (segment, condition)
        Clips whose frames are written as well, since pairs are composed from them.
    limit, kept : int
        Bytes of frames that may stay, and that are there already.

    Raises
    ------
    InputError
        Saying how much is needed and how much is free.
    """
    pixels = look.size**2 * look.frame_rate
    videos = frames = 0.0
    for record in to_do:
        is_clip = isinstance(record, ClipVideo)
        videos += record.duration * (pixels * (_CLIP if is_clip else _PAIR) + _SOUND)
        if isinstance(record, ClipVideo) and _has_frames(record, sides):
            frames += record.duration * pixels * _FRAMES
        there = folder / record.file
        videos -= there.stat().st_size if there.is_file() else 0
    needed = max(0.0, videos) + min(frames, max(0, limit - kept))
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise InputError(
            f"rendering may need {as_text(needed)}, and {as_text(free)} are free on this disk",
            where=folder,
            remedy="Make room, or make smaller videos (video.size in study.toml)",
        )


def _has_frames(clip: ClipVideo, sides: Collection[tuple[str, str]]) -> bool:
    return clip.speech is None and (clip.segment, clip.condition) in sides


def as_text(size: float) -> str:
    """Return a number of bytes as people read it."""
    unit, name = next(((unit, name) for unit, name in _UNITS if size >= unit), (1000, "kB"))
    return f"{size / unit:.1f} {name}"
