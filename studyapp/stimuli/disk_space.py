"""Whether the disk has room for a rendering, checked before it starts."""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.look import Look
from studyapp.study.media import ClipVideo, PairVideo

MAX_FRAME_BYTES: Final = 20 * 10**9
"""Bytes of cached frames if the disk has room."""

# Bytes per frame and pixel of one clip: twice those of a gesturing upper body.
_FRAME_CACHE: Final = 0.07
_CLIP: Final = 0.02
_PAIR: Final = 0.03
_SOUND: Final = 20_000
"""Bytes per second of sound and container."""

_UNITS: Final = ((10**9, "GB"), (10**6, "MB"))


def frames_limit(folder: Path, kept: int) -> int:
    """Return the bytes of frames to keep: `MAX_FRAME_BYTES`, or half of the free disk space.

    Parameters
    ----------
    folder : Path
        A folder on the disk.
    kept : int
        Bytes of frames that are already there.
    """
    return min(MAX_FRAME_BYTES, (shutil.disk_usage(folder).free + kept) // 2)


def require_space(
    folder: Path,
    videos: Iterable[ClipVideo | PairVideo],
    look: Look,
    *,
    sides: Collection[tuple[str, str]],
    limit: int,
    kept: int,
) -> None:
    """Raise `InputError` if the disk would be full before the end of a rendering.

    Parameters
    ----------
    folder : Path
        The study folder.
    videos : iterable of ClipVideo and PairVideo
        Videos to render; files that they replace are subtracted.
    look : Look
        Size and frame rate of the videos.
    sides : collection of (segment, condition)
        Clips whose frames are cached too, since pairs are composed of them.
    limit, kept : int
        Bytes of frames that may be cached, and that already are.
    """
    pixels = look.size**2 * look.frame_rate
    video_bytes = frame_bytes = 0.0
    for video in videos:
        is_clip = isinstance(video, ClipVideo)
        video_bytes += video.duration * (pixels * (_CLIP if is_clip else _PAIR) + _SOUND)
        if isinstance(video, ClipVideo) and _has_frames(video, sides):
            frame_bytes += video.duration * pixels * _FRAME_CACHE
        replaced = folder / video.file
        video_bytes -= replaced.stat().st_size if replaced.is_file() else 0
    needed = max(0.0, video_bytes) + min(frame_bytes, max(0, limit - kept))
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise InputError(
            f"rendering may need {format_size(needed)}, but only {format_size(free)} are free",
            where=folder,
            remedy="Free up space, or make smaller videos (video.size in study.toml)",
        )


def _has_frames(clip: ClipVideo, sides: Collection[tuple[str, str]]) -> bool:
    return clip.speech is None and (clip.segment, clip.condition) in sides


def format_size(size: float) -> str:
    """Return a number of bytes in kB, MB or GB."""
    unit, name = next(((unit, name) for unit, name in _UNITS if size >= unit), (1000, "kB"))
    return f"{size / unit:.1f} {name}"
