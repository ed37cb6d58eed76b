"""Take the pictures of docs/guide.md after its run: ``python -m tools.guide_pictures FOLDER``.

A participant's page with its videos playing, the researchers' overview of the rehearsal, the first
figure of the report, and the strip of frames.
"""

import sys
from pathlib import Path

from PIL import Image

from studyapp.study.folder import StudyFolder
from tests.functional.joining import join
from tools.pictures import DOCS, play_first_trial, served

PICTURES = DOCS / "guide"
FROM_PROLIFIC = "?PROLIFIC_PID=5f3c1d9e7a2b4c6d8e0f1a2b&STUDY_ID=6a1b2c3d&SESSION_ID=7e8f9a0b"
"""The query with which Prolific sends participants."""
QUALITY = 80
SEGMENT = "1_ada_0_65_65"
"""The segment of the guide's strip."""
STRIP_WIDTH = 1100


def picture_strip(folder: StudyFolder) -> None:
    """Shrink the strip to the width of a page."""
    with Image.open(folder.figures / f"strip-{SEGMENT}.png") as picture:
        small = picture.convert("RGB")
        small.thumbnail((STRIP_WIDTH, STRIP_WIDTH))
        small.save(PICTURES / "strip.jpg", quality=QUALITY, optimize=True)


def main() -> None:
    """Take all pictures of the study ``my-study`` in the folder named on the command line."""
    folder = StudyFolder(Path(sys.argv[1]) / "my-study")
    PICTURES.mkdir(exist_ok=True)
    with served(folder) as study:
        page = study.page
        play_first_trial(page, f"{study.address}{FROM_PROLIFIC}", study.database)
        page.screenshot(path=PICTURES / "participant.jpg", quality=QUALITY)
        join(page, study.link)
        page.goto(f"{study.address}research/rehearsal/")
        page.locator(".truth").wait_for()
        page.screenshot(path=PICTURES / "overview.jpg", quality=QUALITY)
        page.set_viewport_size({"width": 1000, "height": 800})
        page.goto((folder.report / "report.html").resolve().as_uri())
        page.locator("figure").first.screenshot(
            path=PICTURES / "preferences.jpg", type="jpeg", quality=QUALITY
        )
    picture_strip(folder)


if __name__ == "__main__":
    main()
