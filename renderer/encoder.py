"""Encoding H.264 and AAC into one file through PyAV, with equal bytes for equal input.

Neither the size nor a bit rate of an MP4 file reveals its content.
"""

import re
import shutil
from collections.abc import Sequence
from fractions import Fraction
from mmap import mmap
from pathlib import Path
from typing import Any, Final, Self

import av
import numpy as np
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
from numpy.typing import NDArray

from motion.audio import Audio
from motion.files import replacing

SOUND_RATE: Final = 48000
"""Samples per second of the sound in a video."""

# With the codecs' flag of that name: no version texts, no random identifiers.
_BITEXACT: Final = {"fflags": "+bitexact"}
MP4_OPTIONS: Final = {**_BITEXACT, "movflags": "+faststart", "write_btrt": "0"}
"""Options of MP4 files: they play while they load, and have no data about their creation.

A box of bit rates would distinguish encoded files from copied ones."""

# Without x264's macroblock tree, whose bytes differ from run to run. A figure in front of a plain
# background has no cuts or fades to look ahead for: the same quality takes 3/4 of the time.
_STREAM_OPTIONS: Final = {
    "crf": "18",
    "preset": "veryfast",
    "x264-params": "mbtree=0:b-adapt=0:scenecut=0:rc-lookahead=0",
}
_LOSSLESS_OPTIONS: Final = {"qp": "0", "preset": "ultrafast"}
_SOUND_BITS_PER_SECOND: Final = 128_000

_HEADER: Final = 8
"""Bytes of a box header: four for its size, four for its type (ISO/IEC 14496-12, 4.2)."""
_SOUND_RATES: Final = re.compile(
    rb"esds.{4}\x03[\x80-\xff]{3}.{4}\x04[\x80-\xff]{3}.{2}\x15.{3}(?P<rates>.{8})", re.DOTALL
)
"""FFmpeg's descriptor of a stream of sound: tag and length, always in four bytes, of the stream's
and of the decoder's descriptor, kind of stream, size of the buffer, then the largest and the mean
bit rate (ISO/IEC 14496-1, 7.2.6.5 and 7.2.6.6)."""


def video_frame(picture: NDArray[np.uint8]) -> Any:
    """Return an RGB `picture`, shape (H, W, 3), as an `av.VideoFrame` in BT.709 yuv420p."""
    return av.VideoFrame.from_ndarray(picture, format="rgb24").reformat(
        format="yuv420p",
        src_color_range=ColorRange.JPEG,
        dst_color_range=ColorRange.MPEG,
        dst_colorspace=Colorspace.ITU709,
    )


def encoded_sound(container: Any, sound: Audio) -> list[Any]:
    """Add a stream of AAC to `container` and return its packets; speech is short, so all at once.

    Parameters
    ----------
    container : av.container.OutputContainer
        The container of the stream.
    sound : Audio
        The sound, at `SOUND_RATE`.
    """
    stream = container.add_stream("aac", rate=SOUND_RATE, layout="mono")
    stream.bit_rate = _SOUND_BITS_PER_SECOND
    stream.codec_context.options = {"flags": "+bitexact"}
    frame = av.AudioFrame.from_ndarray(
        np.ascontiguousarray(sound.samples[None]), format="fltp", layout="mono"
    )
    frame.sample_rate, frame.pts, frame.time_base = SOUND_RATE, 0, Fraction(1, SOUND_RATE)
    return [*stream.encode(frame), *stream.encode(None)]


class VideoWriter:
    """Writes one video file frame by frame; use it as a context manager.

    The file has no date, name or source, and encoding runs on one thread, so that equal frames
    give equal bytes.

    Parameters
    ----------
    path : Path
        The file. With sound it is an MP4 with its index first, so that it plays while it loads;
        without, it is a Matroska file of lossless frames.
    width, height : int
        Size in pixels, even.
    frame_rate : float
        Frames per second.
    sound : Audio or None
        The sound, at `SOUND_RATE`. Without it, the video is lossless.
    """

    def __init__(
        self, path: Path, width: int, height: int, frame_rate: float, sound: Audio | None = None
    ) -> None:
        self._rate = Fraction(frame_rate).limit_denominator(1001)
        self._count = 0
        lossless = sound is None
        self._mp4 = None if lossless else path
        self._container: Any = av.open(
            str(path),
            "w",
            format="matroska" if lossless else "mp4",
            options=_BITEXACT if lossless else MP4_OPTIONS,
        )
        options = _LOSSLESS_OPTIONS if lossless else _STREAM_OPTIONS
        stream = self._container.add_stream(
            "libx264", rate=self._rate, options={**options, "flags": "+bitexact"}
        )
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.thread_count = 1
        stream.time_base = 1 / self._rate
        context = stream.codec_context
        context.color_range = ColorRange.MPEG
        context.color_primaries = ColorPrimaries.BT709
        context.color_trc = ColorTrc.BT709
        context.colorspace = Colorspace.ITU709
        self._video = stream
        self._sound_packets: list[Any] = []
        if sound is not None:
            self._sound_packets = encoded_sound(self._container, sound)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, error_type: type[BaseException] | None, *_: object) -> None:
        if error_type is None:
            self._container.mux(self._video.encode(None))
            self._mux_sound(until=None)
        self._container.close()
        if error_type is None and self._mp4 is not None:
            clear_bit_rates(self._mp4)

    def write(self, frame: Any) -> None:
        """Add `frame`, an `av.VideoFrame` in yuv420p of the video's size."""
        frame.pts = self._count
        frame.time_base = 1 / self._rate
        frame.color_range = ColorRange.MPEG
        frame.colorspace = Colorspace.ITU709
        self._count += 1
        self._container.mux(self._video.encode(frame))
        self._mux_sound(until=self._count / self._rate)

    def _mux_sound(self, until: Fraction | None) -> None:
        """Write the sound up to `until` seconds, or all remaining sound for None."""
        while self._sound_packets:
            packet = self._sound_packets[0]
            if until is not None and packet.pts * packet.time_base > until:
                return
            self._container.mux(self._sound_packets.pop(0))


def clear_bit_rates(video: Path) -> None:
    """Set the largest and the mean bit rate of an MP4 file's sound to 0, for unknown.

    The muxer computes them from the encoded sound, so that they reveal the encoder's settings.
    Players do not need them (ISO/IEC 14496-1, 7.2.6.6).

    Parameters
    ----------
    video : Path
        The file, changed in place; a file without sound stays unchanged.
    """
    with video.open("r+b") as file, mmap(file.fileno(), 0) as content:
        rates = _SOUND_RATES.search(content)
        if rates is not None:
            content[slice(*rates.span("rates"))] = bytes(len(rates["rates"]))


def pad_to_equal_size(videos: Sequence[Path]) -> None:
    """Pad smaller MP4 files to the size of the largest.

    A ``free`` box is appended, which players skip (ISO/IEC 14496-12, 8.1.2).

    Parameters
    ----------
    videos : sequence of Path
        MP4 files that must not be distinguishable by their size.
    """
    sizes = {video: video.stat().st_size for video in videos}
    largest = max(sizes.values(), default=0)
    if all(size == largest for size in sizes.values()):
        return
    if any(0 < largest - size < _HEADER for size in sizes.values()):
        largest += _HEADER
    for video, size in sizes.items():
        padding = largest - size
        if padding:
            _append_free_box(video, padding)


def _append_free_box(video: Path, size: int) -> None:
    with replacing(video) as temporary:
        shutil.copyfile(video, temporary)
        with temporary.open("ab") as file:
            file.write(size.to_bytes(4, "big") + b"free" + bytes(size - _HEADER))
