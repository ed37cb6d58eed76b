"""Go the desk's whole way and show it in docs/desk-way.md: ``python -m tools.desk_way``."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path
from typing import Final

from PIL import Image

from motion.files import write_text
from tests.functional.browsing import commanded, launched, watched_page
from tests.functional.desk_way import Stop, walk_the_desk, write_recordings
from tests.functional.looking import resize
from tools.pictures import DOCS

PAGE: Final = DOCS / "desk-way.md"
PICTURES: Final = DOCS / "desk-way"
COLOURS: Final = 96
"""Of a picture: pages have few, and a picture takes a third of the space."""

HEAD: Final = """\
# A first study at the desk, in pictures

A lab's first study, from login to a rehearsed and served study, without a shell:
[the desk](desk.md) tells more of each page. `make desk-way` goes this way and takes the pictures.
"""


def shown(stop: Stop) -> str:
    """Take the picture of a stop, and return its section of the page."""
    resize(stop.page, {"width": 1100, "height": 700})
    taken = Image.open(io.BytesIO(stop.page.screenshot())).convert("RGB")
    small = taken.quantize(COLOURS, dither=Image.Dither.NONE)
    small.save(PICTURES / f"{stop.name}.png", optimize=True)
    picture = f"{PICTURES.name}/{stop.name}.png"
    return f"\n## {stop.title}\n\n{stop.words}\n\n![{stop.title}]({picture})\n"


def main() -> None:
    """Take all pictures and write the page."""
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
            write_text(PAGE, HEAD + "".join(map(shown, way)))


if __name__ == "__main__":
    main()
