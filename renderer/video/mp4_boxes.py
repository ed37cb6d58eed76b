"""MP4 files that tell neither by their size nor by a bit rate what they show."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO, Final

from motion.files import replacing

_HEADER: Final = 8
"""Bytes of a box header: four for its size, four for its type (ISO/IEC 14496-12, 4.2)."""
_WAY: Final = (b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsd", b"mp4a", b"esds")
_BEFORE_BOXES: Final = {b"stsd": 8, b"mp4a": 28}
"""Bytes of a box's own between its header and the boxes in it (ISO/IEC 14496-12, 8.5 and 12.2)."""
_DECODER: Final = 0x04
"""The descriptor that tells how the sound is decoded (ISO/IEC 14496-1, 7.2.6.6)."""
_BEFORE_RATES: Final = 5
_RATES: Final = 8


def forget_bit_rates(video: Path) -> None:
    """Write 0, for unknown, over the largest and the mean bit rate of the sound of an MP4 file.

    The writer of the file computes them from the encoded sound, so that they tell by which
    settings it was encoded. Players do not need them (ISO/IEC 14496-1, 7.2.6.6).

    Parameters
    ----------
    video : Path
        Changed in its place; a file without sound stays as it is.
    """
    with video.open("r+b") as file:
        _forget(file, 0, file.seek(0, 2), _WAY)


def _forget(file: BinaryIO, start: int, stop: int, way: tuple[bytes, ...]) -> None:
    """Follow `way` through the boxes between `start` and `stop`."""
    while start + _HEADER <= stop:
        file.seek(start)
        header = file.read(_HEADER)
        size, kind = int.from_bytes(header[:4], "big"), header[4:]
        if size < _HEADER:  # the last box, to the end of the file, or one above 4 GiB: no index
            return
        if kind == way[0]:
            inner = start + _HEADER + _BEFORE_BOXES.get(kind, 0)
            if len(way) > 1:
                _forget(file, inner, start + size, way[1:])
            else:
                _overwrite(file, inner, start + size)
        start += size


def _overwrite(file: BinaryIO, start: int, stop: int) -> None:
    """Write over the rates in the descriptors of an ``esds`` box."""
    file.seek(start)
    content = file.read(stop - start)
    # Four bytes of version and flags, then the stream's descriptor: tag, length, name and flags.
    _, inner = _descriptor(content, 4)
    flags = content[inner + 2]
    inner += 3 + (2 if flags & 0x80 else 0) + (2 if flags & 0x20 else 0)
    if flags & 0x40:
        inner += 1 + content[inner]
    tag, inner = _descriptor(content, inner)
    if tag == _DECODER:
        file.seek(start + inner + _BEFORE_RATES)
        file.write(bytes(_RATES))


def _descriptor(content: bytes, at: int) -> tuple[int, int]:
    """Return the tag of the descriptor at `at`, and where it begins behind its length."""
    tag, at = content[at], at + 1
    while content[at] & 0x80:  # a length has seven bits a byte, and the last byte no eighth
        at += 1
    return tag, at + 1


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
