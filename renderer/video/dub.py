"""The same picture with another speech."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np

from motion.audio import Audio, read_audio
from motion.errors import InputError
from motion.files import replacing
from renderer.video.encoder import MP4_OPTIONS, SOUND_RATE, encoded_sound
from renderer.video.loudness import at_common_loudness
from renderer.video.mp4_boxes import forget_bit_rates


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
