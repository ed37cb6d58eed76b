"""Copies of MP4 videos that keep the picture as it is encoded, with its own or another speech."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from av.bitstream import BitStreamFilterContext

from motion.audio import Audio, read_audio
from motion.errors import InputError
from motion.files import replacing
from renderer.encoder import MP4_OPTIONS, SOUND_RATE, encoded_sound, forget_bit_rates
from renderer.loudness import at_common_loudness

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


def write_dubbed(
    *, picture: Path, speech: Path, start: float, end: float, seconds: float, video: Path
) -> None:
    """Write a video whose encoded picture is that of another one, and only its speech differs.

    Parameters
    ----------
    picture : Path
        A video as `renderer.clip_video.write_clip_video` leaves it.
    speech : Path
        What is heard instead.
    start, end : float
        The excerpt of `speech` in seconds.
    seconds : float
        How long the sound lasts: silence follows a shorter excerpt, so that the length of a file
        does not tell whose speech it has.
    video : Path
        Where to write; appears whole, or not at all.

    Raises
    ------
    InputError
        If picture or speech cannot be read.
    """
    heard = at_common_loudness(read_audio(speech, sample_rate=SOUND_RATE).cut(start, end))
    sound = _lasting(heard, round(seconds * SOUND_RATE))
    try:
        with replacing(video) as draft:
            with (
                av.open(str(picture)) as original,
                av.open(str(draft), "w", format="mp4", options=MP4_OPTIONS) as copy,
            ):
                _write(original, copy, sound)
            forget_bit_rates(draft)
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"the rendered clip cannot be read ({error})",
            where=picture,
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
    # A muxer sorts by time only within 10 s; a longer file would tell that it was dubbed.
    copy.mux(sorted(packets, key=lambda packet: packet.dts * Fraction(packet.time_base)))


def _lasting(sound: Audio, count: int) -> Audio:
    samples: Any = sound.samples[:count]
    return replace(sound, samples=np.pad(samples, (0, count - len(samples))))
