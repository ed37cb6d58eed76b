"""The files in ``docs/deploy.md``: each block is what `motionjury deploy` writes.

After its language, a block names the file and its deployment.

``make pages`` brings the page up to date.
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from motion.files import write_text
from studyapp.custody.deployment import STUDIES, Deployment, deployed_files
from tools.handbook.fenced import Fenced, fenced_blocks, with_body

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "deploy.md"
MARK: Final = "file"

FIRST: Final = Deployment(
    title="Gestures and speech",
    folder=STUDIES / "my-study",
    host="study.example.org",
    contact="ada@example.org",
)

DEPLOYMENTS: Final[Mapping[str, Deployment]] = MappingProxyType(
    {
        "": FIRST,
        "second": FIRST.model_copy(
            update={"proxy": "nginx", "database": "postgresql", "prefix": "/studies/one"}
        ),
    }
)
"""The page's deployments, by the word after a file's name."""


def shown_files(page: str) -> list[Fenced]:
    """Return the blocks of the page that are files, in order."""
    return [block for block in fenced_blocks(page) if block.words[:1] == (MARK,)]


def up_to_date(page: str) -> str:
    """Return the page with every file up to date."""
    for block in reversed(shown_files(page)):
        name, deployment = (*block.words[1:], "")[:2]
        files = {file.name: file.text for file in deployed_files(DEPLOYMENTS[deployment])}
        page = with_body(page, block, files[name])
    return page


if __name__ == "__main__":
    write_text(PAGE, up_to_date(PAGE.read_text("utf-8")))
