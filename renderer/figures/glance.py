"""A rendered video at a glance: some of its moments, where the figure was, how much it moved."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import av
import numpy as np
from av.video.reformatter import ColorRange, Interpolation, VideoReformatter
from numpy.typing import NDArray

from motion.errors import InputError
from renderer.look import Look

MOMENTS: Final = 7
TILE_SIZE: Final = 112
"""Pixels along each side of a small picture."""

_LUMA_WEIGHTS: Final = np.array([0.2126, 0.7152, 0.0722], np.float32)
"""Weights of RGB in a pixel's lightness."""
_FIGURE_CONTRAST: Final = 10
"""Of 255: pixels that differ by this much from the background belong to the figure."""
_STILL_CHANGE: Final = 2.5
"""Of 255: encoding alone changes no pixel of the thumbnail by more between frames."""
_STILL_SECONDS: Final = 1.0
_JUMP_CHANGE: Final = 30.0
_RESTLESS_CHANGE: Final = 20.0
"""Of 255, mean change of the figure's small pixels from frame to frame at 30 frames a second.
Gesturing speakers have a median of 1 to 5 and rarely pass 20; a clip broken on purpose has 40."""
_EMPTY_SHARE: Final = 0.02
_OUTSIDE_SHARE: Final = 0.02
_RATE: Final = 30.0


@dataclass(frozen=True, eq=False)
class Glance:
    """A summary of one video.

    Attributes
    ----------
    times : tuple of float
        The moments in seconds, `MOMENTS` of them, evenly spread.
    pictures : ndarray, shape (MOMENTS, SIDE, SIDE, 3), uint8
        RGB at these moments.
    presence : ndarray, shape (SIDE, SIDE), float32
        In which share of the frames the figure was at each place.
    movement : ndarray, shape (T - 1,), float32
        Mean change of the figure's pixels from frame to frame, of 255.
    remarks : tuple of str
        Remarks on stillness, jumps, or a figure that leaves the picture.
    """

    times: tuple[float, ...]
    pictures: NDArray[np.uint8]
    presence: NDArray[np.float32]
    movement: NDArray[np.float32]
    remarks: tuple[str, ...]


def glance_at(video: Path, look: Look | None = None) -> Glance:
    """Return a summary of a video of a figure before a plain background.

    Parameters
    ----------
    video : Path
        The video of one clip.
    look : Look or None
        Its look; None for the default.

    Raises
    ------
    InputError
        If it cannot be read as a video.
    """
    try:
        with av.open(str(video)) as container:
            stream = container.streams.video[0]
            rate = float(stream.average_rate or _RATE)
            frames = np.stack(list(_small_frames(container)))
    except (av.FFmpegError, OSError, IndexError, ValueError) as error:
        raise InputError(
            "the video cannot be read", where=video, remedy="Delete it and render again"
        ) from error
    count = len(frames)
    used_look = look or Look()
    moments = [int((place + 0.5) * count / MOMENTS) for place in range(MOMENTS)]
    luma = frames @ _LUMA_WEIGHTS
    figure = np.abs(luma - round(float(_LUMA_WEIGHTS @ used_look.background))) > _FIGURE_CONTRAST
    change = np.abs(np.diff(luma, axis=0))
    either = figure[1:] | figure[:-1]
    movement = (change * either).sum(axis=(1, 2)) / np.maximum(either.sum(axis=(1, 2)), 1)
    largest = np.percentile(change, 99.8, axis=(1, 2)) if count > 1 else np.zeros(0)
    return Glance(
        times=tuple(round(frame / rate, 3) for frame in moments),
        pictures=frames[moments],
        presence=figure.mean(axis=0, dtype=np.float32),
        movement=movement.astype(np.float32),
        remarks=(
            *_stillness(largest <= _STILL_CHANGE, rate),
            *_restlessness(movement * rate / _RATE, rate),
            *_absence(figure, cropped=used_look.framing in ("face", "hands")),
        ),
    )


def _small_frames(container: av.container.InputContainer) -> Iterator[NDArray[np.uint8]]:
    """Yield each frame as RGB of `TILE_SIZE` × `TILE_SIZE` pixels."""
    reformatter = VideoReformatter()
    for frame in container.decode(video=0):
        small = reformatter.reformat(
            frame,
            width=TILE_SIZE,
            height=TILE_SIZE,
            format="rgb24",
            interpolation=Interpolation.AREA,
            src_color_range=ColorRange.MPEG,
            dst_color_range=ColorRange.JPEG,
        )
        yield np.asarray(small.to_ndarray(), np.uint8)


def _stillness(is_still: NDArray[np.bool_], rate: float) -> Iterator[str]:
    """Yield when nothing moves for `_STILL_SECONDS` or longer."""
    if is_still.all():
        yield "never moves"
        return
    edges = np.diff(np.concatenate([[0], is_still.astype(int), [0]]))
    for start, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if (end - start) / rate >= _STILL_SECONDS:
            yield f"still from {start / rate:.1f} to {end / rate:.1f} s"


def _restlessness(movement: NDArray[np.float64], rate: float) -> Iterator[str]:
    """Yield whether all of it jerks, or where it jumps."""
    if not len(movement):
        return
    if np.median(movement) > _RESTLESS_CHANGE:
        yield "jerks throughout"
        return
    jumps = np.flatnonzero(movement > _JUMP_CHANGE)
    if len(jumps):
        times = ", ".join(f"{(jump + 1) / rate:.1f}" for jump in jumps[:3])
        yield f"jumps at {times} s" + (f" and {len(jumps) - 3} times more" * (len(jumps) > 3))


def _absence(figure: NDArray[np.bool_], *, cropped: bool) -> Iterator[str]:
    """Yield whether the figure is missing or reaches over an edge; the lower one always may.

    Where only a part of it is framed, it may reach over any.
    """
    is_empty = figure.mean(axis=(1, 2)) < _EMPTY_SHARE
    if is_empty.any():
        yield f"nobody in the picture {np.mean(is_empty):.0%} of the time"
    is_outside = figure[:, 0].any(axis=1) | figure[:, :, [0, -1]].any(axis=(1, 2))
    if not cropped and np.mean(is_outside) > _OUTSIDE_SHARE:
        yield f"out of the picture {np.mean(is_outside):.0%} of the time"
