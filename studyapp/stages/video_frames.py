"""Single frames of a video."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import av
from av.video.frame import VideoFrame
from av.video.reformatter import ColorRange, Interpolation, VideoReformatter
from PIL import Image

from motion.errors import InputError


def frames_at(video: Path, moments: Sequence[float], side: int) -> tuple[Image.Image, ...]:
    """Return the frames that a video shows at some moments, made smaller.

    Parameters
    ----------
    video : Path
        Any video that FFmpeg reads.
    moments : sequence of float
        Seconds from the beginning, in ascending order; one past the end gives the last frame.
    side : int
        Pixels that the longer side has.

    Raises
    ------
    InputError
        If it cannot be read as a video.
    """
    found: list[Image.Image] = []
    try:
        with av.open(str(video)) as container:
            stream = container.streams.video[0]
            half = 0.5 / float(stream.average_rate or 30)
            reformatter = VideoReformatter()
            last = None
            for frame in container.decode(stream):
                last = frame
                while len(found) < len(moments) and (frame.time or 0) + half > moments[len(found)]:
                    found.append(_small(reformatter, frame, side))
                if len(found) == len(moments):
                    break
            if last is None:
                raise ValueError("no frame")
            found += [_small(reformatter, last, side)] * (len(moments) - len(found))
    except (av.FFmpegError, OSError, IndexError, ValueError) as error:
        raise InputError(
            "the video cannot be read", where=video, remedy="Delete it and render again"
        ) from error
    return tuple(found)


def _small(reformatter: VideoReformatter, frame: VideoFrame, side: int) -> Image.Image:
    scale = side / max(frame.width, frame.height)
    small = reformatter.reformat(
        frame,
        width=max(2, round(frame.width * scale)),
        height=max(2, round(frame.height * scale)),
        format="rgb24",
        interpolation=Interpolation.AREA,
        src_color_range=ColorRange.MPEG,
        dst_color_range=ColorRange.JPEG,
    )
    return Image.fromarray(small.to_ndarray())
