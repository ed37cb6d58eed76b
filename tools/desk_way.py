"""Take the pictures of docs/desk-way.md from the desk: ``python -m tools.desk_way``."""

import io
import tempfile
from pathlib import Path
from typing import Final

from PIL import Image
from playwright.sync_api import ViewportSize

from tests.functional.browsing import commanded, launched, watched_page
from tests.functional.desk_way import Stop, walk_the_desk, write_recordings
from tests.functional.page_checks import resize
from tools.pictures import DOCS

PICTURES: Final = DOCS / "desk-way"
COLOURS: Final = 96
"""Colours of a picture: pages have few, and a palette takes a third of the space."""

SIZE: Final[ViewportSize] = {"width": 1100, "height": 700}


def picture(stop: Stop) -> None:
    """Take the picture of a stop."""
    resize(stop.page, SIZE)
    taken = Image.open(io.BytesIO(stop.page.screenshot())).convert("RGB")
    small = taken.quantize(COLOURS, dither=Image.Dither.NONE)
    small.save(PICTURES / f"{stop.name}.png", optimize=True)


def main() -> None:
    """Take all pictures."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        lab = Path(scratch) / "gesture-lab"
        lab.mkdir()
        recordings = write_recordings(Path(scratch) / "recordings", seconds=3)
        with (
            launched() as browser,
            commanded("desk", lab) as (address, link),
            watched_page(browser, address, refused=422) as page,
            watched_page(browser, address) as visitor,
        ):
            way = walk_the_desk(page, visitor, link, recordings, participants=12, size=480)
            for stop in way:
                picture(stop)


if __name__ == "__main__":
    main()
