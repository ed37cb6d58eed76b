"""H.264 and AAC into one file through PyAV, the same bytes for the same input."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any, Final, Self

import av
import numpy as np
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
from numpy.typing import NDArray

from motion.audio import Audio
from renderer.video.mp4_boxes import forget_bit_rates

SOUND_RATE: Final = 48000
"""Samples per second of the sound in a video."""

# With the codecs' flag of that name: no version texts, no random identifiers.
_BITEXACT: Final = {"fflags": "+bitexact"}
MP4_OPTIONS: Final = {**_BITEXACT, "movflags": "+faststart", "write_btrt": "0"}
"""How MP4 files are written: they play while they load, and say nothing of their making.

A box of bit rates would tell what was encoded from what was copied."""

_CLOCK: Final = 1_000_000
# Without x264's macroblock tree, which makes other bytes of the same frames from run to run. One
# figure before a plain background has no cuts or fades to look ahead for: as good, in 3/4 the time.
_STREAM_OPTIONS: Final = {
    "crf": "18",
    "preset": "veryfast",
    "x264-params": "mbtree=0:b-adapt=0:scenecut=0:rc-lookahead=0",
}
_LOSSLESS_OPTIONS: Final = {"qp": "0", "preset": "ultrafast"}
_SOUND_BITS_PER_SECOND: Final = 128_000


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
        Where they will be written.
    sound : Audio
        What is heard, at `SOUND_RATE`.
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

    Nothing in the file says when, where, by what name or from what it was made, and encoding
    runs on one thread, so that the same frames give the same bytes.

    Parameters
    ----------
    path : Path
        Where to write. With sound it is an MP4 whose index comes first, so that it plays while
        it loads; without, a Matroska file of frames kept without loss.
    width, height : int
        Pixels, even.
    frame_rate : float
        Frames per second.
    sound : Audio or None
        What is heard, at `SOUND_RATE`. Without it, the video is lossless.
    """

    def __init__(
        self, path: Path, width: int, height: int, frame_rate: float, sound: Audio | None = None
    ) -> None:
        self._rate = Fraction(frame_rate).limit_denominator(1001)
        self._count = 0
        lossless = sound is None
        self._heard_in = None if lossless else path
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

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self._container.mux(self._video.encode(None))
            self._mux_sound(until=None)
        self._container.close()
        if kind is None and self._heard_in is not None:
            forget_bit_rates(self._heard_in)

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
        """Write the sound that is heard before `until` seconds; all that is left for None."""
        while self._sound_packets:
            packet = self._sound_packets[0]
            if until is not None and packet.pts * packet.time_base > until:
                return
            self._container.mux(self._sound_packets.pop(0))
