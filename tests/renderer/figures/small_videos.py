"""Videos of a moving block, for code that reads videos without drawing any."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from renderer.encoder import VideoWriter, video_frame
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
