"""Videos of a moving block, for code that reads videos without drawing any; and a sheet."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from motion.segment import Segment
from renderer.encoder import VideoWriter, video_frame
from renderer.figures.sheet import Sheet, SheetCell
from renderer.look import BACKGROUND, Colour

SIZE = 128


def write_block_video(
    path: Path, places: Sequence[int | None], background: Colour = BACKGROUND
) -> Path:
    """Write a lossless video of a blue block whose left edge is at each of `places`.

    None shows only the background.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with VideoWriter(path, SIZE, SIZE, 30) as writer:
        for place in places:
            picture = np.full((SIZE, SIZE, 3), background, np.uint8)
            if place is not None:
                picture[30:, max(place, 0) : place + 40] = (40, 60, 90)
            writer.write(video_frame(picture))
    return path


CONDITIONS = tuple(f"condition_{k}" for k in range(6))


def sheet_of(conditions: Sequence[str], picture: bytes | None = None) -> Sheet:
    """Return a sheet of two segments; the first condition may have pictures."""
    segments = tuple(
        Segment(
            name=name, wav="a.wav", start=0, end=2, speaker="robin", emotion=emotion,
            transcript=text,
        )
        for name, emotion, text in (("one", "anger", "<b>Die Straße"), ("two", "fear", "a house"))
    )  # fmt: skip
    cells = {
        (segment.name, condition): SheetCell(
            picture=picture if condition == conditions[0] else None,
            remark="jumps at 1.0 s" * (segment.name == "two"),
            video="../../videos/clips/one.mp4",
        )
        for segment in segments
        for condition in conditions
    }
    return Sheet(
        title="Who & why", facts="12 clips", conditions=tuple(conditions),
        roles={conditions[0]: "reference"}, segments=segments, cells=cells,
    )  # fmt: skip
