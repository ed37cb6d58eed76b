"""Copies of MP4 videos with the same encoded picture, and with the same or another speech."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from av.bitstream import BitStreamFilterContext

from motion.audio import Audio
from motion.errors import InputError
from motion.files import replacing
from renderer.encoder import MP4_OPTIONS, SOUND_RATE, clear_bit_rates, encoded_sound
from renderer.loudness import read_excerpt
from renderer.video_jobs import DubJob

TICKS: Final = 90_000
"""Ticks per second of a copy's timestamps."""

_SEI: Final = "filter_units=remove_types=6"
"""Removes supplemental information, which names the encoder (H.264, annex D)."""


def end_of(video: Path) -> Fraction:
    """Return the time in seconds at which a video's picture and sound have ended.

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
    """Write an MP4 with the encoded picture of `source`, optionally its sound, and no metadata.

    The index comes first, so that it plays while it loads. Nothing is encoded again.

    Parameters
    ----------
    source : Path
        A video in H.264, with sound in AAC if the copy has sound.
    target : Path
        The copy; appears whole, or not at all.
    lasts : Fraction
        Duration of the copy in seconds, at least that of `source`; rounded up to milliseconds. The
        last picture is held until then.
    sound : bool
        Whether the copy has sound.

    Raises
    ------
    InputError
        If `source` cannot be read.
    """
    # Whole milliseconds, the unit of the file's own duration.
    end = ceil(lasts * 1000) * (TICKS // 1000)
    options = {**MP4_OPTIONS, "video_track_timescale": str(TICKS)}
    try:
        with _opened(source, target, options) as (original, copy):
            _copy(original, copy, end, sound=sound)
    except (av.FFmpegError, OSError, IndexError) as error:
        raise _unreadable(source) from error


@contextmanager
def _opened(source: Path, target: Path, options: dict[str, str]) -> Iterator[tuple[Any, Any]]:
    """Open `source`, and `target` as a new MP4 file without bit rates."""
    with replacing(target) as draft:
        with (
            av.open(str(source)) as original,
            av.open(str(draft), "w", format="mp4", options=options) as copy,
        ):
            yield original, copy
        clear_bit_rates(draft)


def _copy(original: Any, copy: Any, end: int, *, sound: bool) -> None:
    """Copy the packets of `original` into `copy`, the last picture shown until tick `end`."""
    selected: list[Any] = [original.streams.video[0]]
    selected += original.streams.audio[:1] if sound else []
    streams = {stream.index: copy.add_stream_from_template(stream) for stream in selected}
    picture = selected[0]
    sei_filter = BitStreamFilterContext(_SEI, picture, streams[picture.index])
    for packet in _packets(original, selected, picture, end):
        for out_packet in sei_filter.filter(packet) if packet.stream is picture else [packet]:
            out_packet.stream = streams[packet.stream.index]
            copy.mux(out_packet)


def _packets(original: Any, selected: list[Any], picture: Any, end: int) -> list[Any]:
    """Return the packets of the `selected` streams, the last picture shown until tick `end`."""
    packets = [packet for packet in original.demux(selected) if packet.pts is not None]
    pictures = [packet for packet in packets if packet.stream is picture]
    for packet in pictures:
        ticks = Fraction(packet.time_base) * TICKS
        packet.pts, packet.dts = round(packet.pts * ticks), round(packet.dts * ticks)
        packet.duration, packet.time_base = round(packet.duration * ticks), Fraction(1, TICKS)
    last_shown = max(pictures, key=lambda packet: packet.pts)
    last_shown.duration = end - last_shown.pts
    # The file's duration depends on decoding order, in which the last picture can be another one.
    pictures[-1].duration = end - (pictures[-1].dts - pictures[0].dts)
    return packets


def _unreadable(video: Path) -> InputError:
    return InputError(
        "the video cannot be played",
        where=video,
        remedy="Convert it to H.264 and AAC in MP4",
    )


def write_dubbed(job: DubJob) -> None:
    """Write a video with the encoded picture of another one and a different speech.

    It appears whole, or not at all.

    Raises
    ------
    InputError
        If picture or speech cannot be read.
    """
    excerpt = read_excerpt(job.speech, job.start, job.end)
    sound = _padded(excerpt, round(job.seconds * SOUND_RATE))
    try:
        with _opened(job.picture, job.video, MP4_OPTIONS) as (original, copy):
            _write(original, copy, sound)
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"the rendered clip cannot be read ({error})",
            where=job.picture,
            remedy="Delete the file and render again",
        ) from error


def _write(original: Any, copy: Any, sound: Audio) -> None:
    """Write the encoded picture of `original` and `sound` into `copy`."""
    source = original.streams.video[0]
    picture = copy.add_stream_from_template(source)
    packets = encoded_sound(copy, sound)
    for packet in original.demux(source):
        if packet.pts is not None:
            packet.stream = picture
            packets.append(packet)
    # The muxer sorts by time only within 10 s; a longer file would reveal that it was dubbed.
    copy.mux(sorted(packets, key=lambda packet: packet.dts * Fraction(packet.time_base)))


def _padded(sound: Audio, count: int) -> Audio:
    samples: Any = sound.samples[:count]
    return replace(sound, samples=np.pad(samples, (0, count - len(samples))))
