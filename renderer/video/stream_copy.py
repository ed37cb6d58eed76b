"""Copies of MP4 videos that keep picture and sound as they are encoded, and nothing besides."""

from __future__ import annotations

from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any, Final

import av
from av.bitstream import BitStreamFilterContext

from motion.errors import InputError
from motion.files import replacing
from renderer.video.encoder import MP4_OPTIONS
from renderer.video.mp4_boxes import forget_bit_rates

TICKS: Final = 90_000
"""Parts of a second in which a copy counts the moments of its pictures."""

_SEI: Final = "filter_units=remove_types=6"
"""Leaves out supplemental information, where encoders write who they are (H.264, annex D)."""


def end_of(video: Path) -> Fraction:
    """Return the moment in seconds when the last picture and the last sound of a video are over.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        with av.open(str(video)) as container:
            streams: list[Any] = [*container.streams.video[:1], *container.streams.audio[:1]]
            ends = [
                (packet.pts + (packet.duration or 0)) * Fraction(packet.time_base)
                for packet in container.demux(streams)
                if packet.pts is not None
            ]
            if not ends:
                raise _unreadable(video)
            return max(ends)
    except (av.FFmpegError, OSError) as error:
        raise _unreadable(video) from error


def copy_video(source: Path, target: Path, *, lasts: Fraction, sound: bool) -> None:
    """Write an MP4 with the encoded picture of `source`, its sound if wanted, and no metadata.

    The index comes first, so that it plays while it loads. Nothing is encoded anew.

    Parameters
    ----------
    source : Path
        A video in H.264, with sound in AAC if it is to be kept.
    target : Path
        Where to write; appears whole, or not at all.
    lasts : Fraction
        Seconds that the copy lasts, at least those of `source` and rounded up to milliseconds;
        its last picture is held so long.
    sound : bool
        Whether it is heard.

    Raises
    ------
    InputError
        If `source` cannot be read.
    """
    # Whole milliseconds, in which the file's own length is counted.
    end = ceil(lasts * 1000) * (TICKS // 1000)
    options = {**MP4_OPTIONS, "video_track_timescale": str(TICKS)}
    try:
        with replacing(target) as draft:
            with (
                av.open(str(source)) as original,
                av.open(str(draft), "w", format="mp4", options=options) as copy,
            ):
                _copy(original, copy, end, sound=sound)
            forget_bit_rates(draft)
    except (av.FFmpegError, OSError, IndexError) as error:
        raise _unreadable(source) from error


def _copy(original: Any, copy: Any, end: int, *, sound: bool) -> None:
    """Write what is encoded in `original` into `copy`, the picture held until tick `end`."""
    wanted: list[Any] = [original.streams.video[0]]
    wanted += original.streams.audio[:1] if sound else []
    streams = {stream.index: copy.add_stream_from_template(stream) for stream in wanted}
    picture = wanted[0]
    quiet = BitStreamFilterContext(_SEI, picture, streams[picture.index])
    for packet in _packets(original, wanted, picture, end):
        for kept in quiet.filter(packet) if packet.stream is picture else [packet]:
            kept.stream = streams[packet.stream.index]
            copy.mux(kept)


def _packets(original: Any, wanted: list[Any], picture: Any, end: int) -> list[Any]:
    """Return what is encoded in `wanted` of its streams, the picture held until tick `end`."""
    packets = [packet for packet in original.demux(wanted) if packet.pts is not None]
    pictures = [packet for packet in packets if packet.stream is picture]
    for packet in pictures:
        ticks = Fraction(packet.time_base) * TICKS
        packet.pts, packet.dts = round(packet.pts * ticks), round(packet.dts * ticks)
        packet.duration, packet.time_base = round(packet.duration * ticks), Fraction(1, TICKS)
    shown_last = max(pictures, key=lambda packet: packet.pts)
    shown_last.duration = end - shown_last.pts
    # The file counts by decoding order, in which the last picture can be another one.
    pictures[-1].duration = end - (pictures[-1].dts - pictures[0].dts)
    return packets


def _unreadable(video: Path) -> InputError:
    return InputError(
        "this is not a video that can be played",
        where=video,
        remedy="Bring it as H.264 and AAC in MP4",
    )
