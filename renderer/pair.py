"""Two clips side by side, labelled A and B, as one video."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from motion.errors import InputError
from motion.files import replacing
from renderer.encoder import VideoWriter, video_frame
from renderer.look import Colour, Look
from renderer.loudness import read_excerpt
from renderer.picture import plane_pixels
from renderer.video_jobs import PairJob

LABELS: Final = ("A", "B")
"""Left and right."""

_LABEL_SHARE: Final = 0.085  # of the picture's height
_LABEL_MARGIN: Final = 0.03
_DARK: Final = (0x3C, 0x3C, 0x42)
_LIGHT: Final = (0xFF, 0xFF, 0xFF)
_MIN_GREY_FOR_DARK: Final = 0x8D
"""Level of grey, of 255, from which dark letters have more contrast than light ones."""

Planes = tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.uint8]]


def write_pair(job: PairJob) -> None:
    """Compose two clips into one video with the speech.

    The video appears whole, or not at all.

    Raises
    ------
    InputError
        If frames or speech cannot be read, or the two sides have too few or too many frames.
    """
    size, rate = job.look.size, job.look.frame_rate
    sound = read_excerpt(job.speech, job.start, job.end)
    count = max(1, round((job.end - job.start) * rate))
    written = 0
    with (
        replacing(job.video) as draft,
        VideoWriter(draft, 2 * size, size, rate, sound) as writer,
    ):
        for frame in composed_frames(job.left, job.right, job.look):
            written += 1
            if written <= count:
                writer.write(frame)
        if written != count:
            raise InputError(
                f"the two sides have {written} common frames, but {count} are needed",
                where=f"{job.left} and {job.right}",
                remedy="Render both clips again",
            )


def composed_frames(left: Path, right: Path, look: Look) -> Iterator[Any]:
    """Yield labelled `av.VideoFrame`s of two lossless videos until one of them ends."""
    size = look.size
    labels = [_label(text, size, look.background) for text in LABELS]
    for sides in zip(_frames(left, size), _frames(right, size), strict=False):
        yield _side_by_side(sides, labels, size)


def _frames(path: Path, size: int) -> Iterator[Any]:
    """Yield the frames of a lossless video."""
    if not path.is_file():
        raise InputError("the rendered frames are missing", where=path, remedy="Render the clip")
    try:
        with av.open(str(path)) as container:
            stream = container.streams.video[0]
            stream.thread_count = 1
            if (stream.width, stream.height) != (size, size):
                raise InputError(
                    f"the frames are {stream.width} × {stream.height}, expected {size} × {size}",
                    where=path,
                    remedy="Render the clip again",
                )
            yield from container.decode(stream)
    except (av.FFmpegError, IndexError) as error:
        raise InputError(
            f"the rendered frames cannot be read ({error})",
            where=path,
            remedy="Delete the file and render again",
        ) from error


def _side_by_side(sides: tuple[Any, Any], labels: list[Planes], size: int) -> Any:
    """Return one frame with both sides and their labels."""
    result = av.VideoFrame(2 * size, size, "yuv420p")
    for index, plane in enumerate(result.planes):
        pixels = plane_pixels(plane)
        width = pixels.shape[1] // 2
        for number, (side, label) in enumerate(zip(sides, labels, strict=True)):
            half = pixels[:, number * width : (number + 1) * width]
            half[:] = plane_pixels(side.planes[index])
            mark = label[index]
            place = round(_LABEL_MARGIN * size / 2) * 2 // (1 if index == 0 else 2)
            half[place : place + mark.shape[0], place : place + mark.shape[1]] = mark
    return result


def _label(text: str, size: int, background: Colour) -> Planes:
    """Return a letter on the background's colour as three planes, luma first."""
    tile_size = round(_LABEL_SHARE * size / 2) * 2
    tile = Image.new("RGB", (tile_size, tile_size), background)
    font = ImageFont.load_default(size=tile_size * 0.9)
    grey = float(np.dot(background, [0.2126, 0.7152, 0.0722]))
    ink = _DARK if grey >= _MIN_GREY_FOR_DARK else _LIGHT
    ImageDraw.Draw(tile).text((tile_size / 2, tile_size / 2), text, ink, font=font, anchor="mm")
    planes = video_frame(np.asarray(tile)).planes
    luma, blue, red = (plane_pixels(plane).copy() for plane in planes)
    return luma, blue, red
