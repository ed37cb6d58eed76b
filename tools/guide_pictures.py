"""Take the pictures of docs/guide.md where it was run: ``python -m tools.guide_pictures FOLDER``.

A participant's page with its videos playing, the researchers' overview of the rehearsal, the first
figure of the report, and the strip of frames.
"""

from __future__ import annotations

import shutil
import sys
from contextlib import closing
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

from studyapp.clock import Clock
from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.links import first_owner_link
from studyapp.study.folder import StudyFolder
from tools.pictures import CHROMIUM_FLAGS, DOCS, play_first_trial, served

PICTURES = DOCS / "guide"
FROM_PROLIFIC = "?PROLIFIC_PID=5f3c1d9e7a2b4c6d8e0f1a2b&STUDY_ID=6a1b2c3d&SESSION_ID=7e8f9a0b"
"""Where the guide's participants come from."""
QUALITY = 80
SEGMENT = "1_ada_0_65_65"
"""Of which the guide makes its strip."""
STRIP_WIDTH = 1100
PATIENCE = 180_000
"""Milliseconds that a page may take, also where all processors are busy."""


def picture_overview(page: Page, address: str, database: Path) -> None:
    """Become the study's owner and take the overview of the rehearsal."""
    with closing(Database.open(sqlite_url(database))) as stored:
        link = first_owner_link(stored, Clock())
    page.goto(f"{address}research/join/{link}")
    page.get_by_label("Your name").fill("Ada Lovelace")
    for label in ("New password", "Repeat it"):
        page.get_by_label(label).fill("for this picture only")
    page.get_by_role("button", name="Join").click()
    page.goto(f"{address}research/rehearsal/")
    page.locator(".truth").wait_for()
    page.screenshot(path=PICTURES / "overview.jpg", quality=QUALITY)


def picture_strip(folder: StudyFolder) -> None:
    """Make the strip as small as a page needs it."""
    with Image.open(folder.figures / f"strip-{SEGMENT}.png") as picture:
        small = picture.convert("RGB")
        small.thumbnail((STRIP_WIDTH, STRIP_WIDTH))
        small.save(PICTURES / "strip.jpg", quality=QUALITY, optimize=True)


def main() -> None:
    """Take all pictures of the study ``my-study`` in the folder named on the command line."""
    folder = StudyFolder(Path(sys.argv[1]) / "my-study")
    PICTURES.mkdir(exist_ok=True)
    chromium = shutil.which("chromium")
    with served(folder) as (address, database), sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path=chromium, args=CHROMIUM_FLAGS)
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        page.set_default_timeout(PATIENCE)
        play_first_trial(page, f"{address}{FROM_PROLIFIC}", database)
        page.screenshot(path=PICTURES / "participant.jpg", quality=QUALITY)
        picture_overview(page, address, database)
        page.set_viewport_size({"width": 1000, "height": 800})
        page.goto((folder.report / "report.html").resolve().as_uri())
        page.locator("figure").first.screenshot(
            path=PICTURES / "preferences.jpg", type="jpeg", quality=QUALITY
        )
        browser.close()
    picture_strip(folder)


if __name__ == "__main__":
    main()
