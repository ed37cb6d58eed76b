"""Take the pictures in docs/ from a study: ``python -m tools.pictures demo-study``.

A participant's page with its video playing, the first screen of the report, one rendered frame
of every condition, all avatars, and a figure for a paper.
"""

import os
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import av
from PIL import Image
from playwright.sync_api import Page

from studyapp.database.engine import sqlite_url
from studyapp.study.folder import StudyFolder
from studyapp.study.media import read_stimuli
from tests.functional.browsing import commanded, launched
from tests.functional.page_checks import LAPTOP
from tools.avatars.sheet import everyone

DOCS = Path(__file__).resolve().parent.parent / "docs"
PATIENCE = 180_000
"""Milliseconds that a page may take, even on a busy machine."""
SEGMENT = "happiness"
MOMENT = 2.6
KEY_WORDS = ("house=0.62", "called=1.6", "summer=3.0", "breakfast=4.5", "enormous=5.6", "tree=6.2")
"""Times at which espeak-ng says them in the segment, in seconds."""


@dataclass(frozen=True)
class Served:
    """A study that is served on a temporary database, and a page of a browser.

    Attributes
    ----------
    address : str
        The study's address.
    link : str
        The link by which its first owner joins.
    database : Path
        The temporary database.
    """

    address: str
    link: str
    database: Path
    page: Page


@contextmanager
def served(folder: StudyFolder) -> Iterator[Served]:
    """Serve a study, and yield it with a page of a browser."""
    with tempfile.TemporaryDirectory() as scratch, launched() as browser:
        database = Path(scratch) / "pictures.db"
        os.environ["DATABASE_URL"] = sqlite_url(database)
        with commanded("serve", folder.root, "--workers", "1") as (address, link):
            page = browser.new_page(viewport=LAPTOP)
            page.set_default_timeout(PATIENCE)
            yield Served(f"{address}/", link, database, page)
        folder.elsewhere.unlink()


def play_first_trial(page: Page, address: str, database: Path) -> None:
    """Go to the first trial and play it for a moment."""
    page.goto(address)
    while page.query_selector("#answers") is None:
        if (field := page.query_selector("input[name=digits]")) is not None:
            field.fill(spoken(database))
        page.click("form[method=post] button[type=submit], form[method=post] button")
        page.wait_for_load_state()
    page.evaluate("document.querySelector('#pair').play()")
    page.wait_for_timeout(MOMENT * 1000)


def spoken(database: Path) -> str:
    """Return the digits that the sound check speaks to the only participant."""
    with closing(sqlite3.connect(database)) as connection:
        (digits,) = connection.execute("SELECT sound_digits FROM study_sessions").fetchone()
    return str(digits)


def picture_frames(folder: StudyFolder) -> None:
    """Put one frame of every condition side by side."""
    frames = []
    clips = read_stimuli(folder.stimuli).clips
    for condition in dict.fromkeys(clip.condition for clip in clips):
        with av.open(str(folder.videos / "clips" / condition / f"{SEGMENT}.mp4")) as video:
            at = next(f for f in video.decode(video=0) if (f.time or 0) >= MOMENT)
            frames.append(Image.fromarray(at.to_ndarray(format="rgb24")))
    sheet = Image.new("RGB", (sum(frame.width for frame in frames), frames[0].height))
    for k, frame in enumerate(frames):
        sheet.paste(frame, (k * frame.width, 0))
    sheet.thumbnail((1600, 1600))
    sheet.save(DOCS / "frames.png", optimize=True)


def picture_figure(folder: StudyFolder) -> None:
    """Make a strip of two conditions at the key words of a segment."""
    chosen = [f"--at={word}" for word in KEY_WORDS]
    chosen += [f"--condition={name}" for name in ("rule_based", "mismatched")]
    subprocess.run(
        ["motionjury", "figure", "strip", str(folder.root), "--segment", SEGMENT, *chosen,
         "--inches", "4.6", "--output", str(DOCS / "figure.png")],
        check=True,
    )  # fmt: skip


def main() -> None:
    """Take all pictures of the study named on the command line."""
    folder = StudyFolder(Path(sys.argv[1]))
    with served(folder) as study:
        page = study.page
        play_first_trial(page, study.address, study.database)
        page.screenshot(path=DOCS / "participant.png")
        page.set_viewport_size({"width": 1280, "height": 800})
        page.goto((folder.report / "report.html").resolve().as_uri())
        page.screenshot(path=DOCS / "report.png")
    picture_frames(folder)
    everyone(size=320).save(DOCS / "avatars.png", optimize=True)
    picture_figure(folder)


if __name__ == "__main__":
    main()
