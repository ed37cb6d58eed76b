"""A grid: one to nine clips of one speech side by side with captions, as one video."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image, ImageDraw

from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import replacing
from renderer.clip_video import Stage
from renderer.encoder import VideoWriter, video_frame
from renderer.figures.plate import FAINT_INK, INK, fitted, font, wrapped
from renderer.look import BACKGROUND
from renderer.loudness import at_common_loudness
from renderer.picture import SUPERSAMPLING

MAX_PANELS: Final = 9

_CAPTION_SHARE: Final = 0.11  # height of a caption line, of a panel's side
_LETTER_SHARE: Final = 0.058
_TEXT_LINES: Final = 2
_LINE_SHARE: Final = 0.8  # height of a line of the text, of a caption line


@dataclass(frozen=True, kw_only=True)
class GridLayout:
    """The positions of panels and text in a frame of a grid.

    Attributes
    ----------
    count : int
        Number of panels, up to `MAX_PANELS`.
    size : int
        Pixels along each side of a panel, even.
    text : str
        The spoken text, shown under the grid.
    """

    count: int
    size: int
    text: str = ""

    def __post_init__(self) -> None:
        if not 0 < self.count <= MAX_PANELS:
            raise InputError(
                f"{self.count} clips do not fit into a grid",
                remedy=f"Show 1 to {MAX_PANELS} conditions",
            )

    @property
    def columns(self) -> int:
        """Panels per row: 1 to 3 are in one row, 4 in two rows, 9 in three."""
        return self.count if self.count <= 3 else math.ceil(math.sqrt(self.count))

    @property
    def caption_height(self) -> int:
        """Pixels of the line under each panel; even."""
        return round(self.size * _CAPTION_SHARE / 2) * 2

    @property
    def footer_height(self) -> int:
        """Pixels of the text under all panels, and of the clock below it; even."""
        lines = 1 + (_TEXT_LINES * _LINE_SHARE if self.text else 0)
        return round(lines * self.caption_height / 2) * 2

    @property
    def frame(self) -> tuple[int, int]:
        """Width and height of the video."""
        rows = math.ceil(self.count / self.columns)
        height = rows * (self.size + self.caption_height) + self.footer_height
        return self.columns * self.size, height

    def position(self, number: int) -> tuple[int, int]:
        """Return the upper left corner of a panel; an incomplete last row is centred."""
        row, column = divmod(number, self.columns)
        in_row = min(self.columns, self.count - row * self.columns)
        indent = (self.columns - in_row) * self.size // 2
        left = (indent + column * self.size) // 2 * 2
        return left, row * (self.size + self.caption_height)


def write_grid(
    stage: Stage,
    clips: Mapping[str, MotionClip],
    speech: Audio,
    *,
    text: str,
    video: Path,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Write the video of a grid.

    Parameters
    ----------
    stage : Stage
        The stage that renders all clips; entered. Its look sets the panels' size and the frame
        rate.
    clips : mapping of str to MotionClip
        The clips by caption, as participants see them, all with the same number of frames.
    speech : Audio
        The speech at `renderer.encoder.SOUND_RATE`.
    text : str
        The spoken text; empty if unknown.
    video : Path
        The MP4 to write, which plays while it loads; appears whole, or not at all.
    on_frame : callable
        Called with (frames done, frames in all) after each frame.
    """
    rate = stage.look.frame_rate
    layout = GridLayout(count=len(clips), size=stage.look.size, text=text)
    count = len(next(iter(clips.values())))
    background = _background(layout, list(clips))
    picture_streams = [_pictures(stage, clip) for clip in clips.values()]
    with (
        replacing(video) as draft,
        VideoWriter(draft, *layout.frame, rate, at_common_loudness(speech)) as writer,
    ):
        for number, pictures in enumerate(zip(*picture_streams, strict=True)):
            frame = background.copy()
            for place, picture in enumerate(pictures):
                frame.paste(picture, layout.position(place))
            _write_clock(frame, layout, number / rate)
            writer.write(video_frame(np.asarray(frame)))
            on_frame(number + 1, count)


def _pictures(stage: Stage, clip: MotionClip) -> Iterator[Image.Image]:
    for number in range(len(clip)):
        # Frame by frame, because one stage draws the clips of a grid in turn.
        pixels = next(stage.pictures(clip.frames(slice(number, number + 1))))
        yield Image.fromarray(pixels).reduce(SUPERSAMPLING).convert("RGB")


def _background(layout: GridLayout, captions: Sequence[str]) -> Image.Image:
    """Return the constant parts of all frames: background, captions, text."""
    image = Image.new("RGB", layout.frame, BACKGROUND)
    pen = ImageDraw.Draw(image)
    letters = font(layout.size * _LETTER_SHARE)
    for number, caption in enumerate(captions):
        left, top = layout.position(number)
        centre = left + layout.size / 2, top + layout.size + layout.caption_height / 2
        line_text = fitted(caption, letters, 0.94 * layout.size)
        pen.text(centre, line_text, INK, letters, anchor="mm")
    if layout.text:
        small = font(layout.size * _LETTER_SHARE * 0.82)
        width, height = layout.frame
        room = width - layout.caption_height
        for line, words in enumerate(wrapped(layout.text, small, room, _TEXT_LINES)):
            middle_line = (
                height - layout.footer_height + (0.35 + _LINE_SHARE * line) * layout.caption_height
            )
            pen.text((width / 2, middle_line), words, FAINT_INK, small, anchor="mm")
    return image


def _write_clock(frame: Image.Image, layout: GridLayout, seconds: float) -> None:
    """Write the time of the speech in the lower right corner."""
    pen = ImageDraw.Draw(frame)
    small = font(layout.size * _LETTER_SHARE * 0.7)
    width, height = layout.frame
    middle = height - layout.caption_height * 0.45
    margin = layout.caption_height * 0.3
    pen.text((width - margin, middle), f"{seconds:.1f} s", FAINT_INK, small, anchor="rm")
