"""Equal file sizes, so that a video's size does not tell what it shows."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from motion.files import replacing

_HEADER: Final = 8
"""Bytes of a box header: four for its size, four for its type (ISO/IEC 14496-12, 4.2)."""


def pad_to_equal_size(videos: Sequence[Path]) -> None:
    """Lengthen the smaller MP4 files until all have the size of the largest.

    A ``free`` box is appended, which players skip (ISO/IEC 14496-12, 8.1.2).

    Parameters
    ----------
    videos : sequence of Path
        MP4 files that must not be told apart by their size.
    """
    sizes = {video: video.stat().st_size for video in videos}
    largest = max(sizes.values(), default=0)
    if all(size == largest for size in sizes.values()):
        return
    if any(0 < largest - size < _HEADER for size in sizes.values()):
        largest += _HEADER
    for video, size in sizes.items():
        missing = largest - size
        if missing:
            _append_free_box(video, missing)


def _append_free_box(video: Path, size: int) -> None:
    with replacing(video) as temporary:
        shutil.copyfile(video, temporary)
        with temporary.open("ab") as file:
            file.write(size.to_bytes(4, "big") + b"free" + bytes(size - _HEADER))
