"""Running the guide and the commands' examples, and writing what they print into them.

``python -m studyapp.handbook.guide FOLDER`` runs ``docs/guide.md`` in an empty FOLDER, then the
examples of ``docs/commands`` in what it left there. Twice the same commands print the same, so that
a page changes only where the program did.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from motion.errors import InputError
from motion.files import write_text
from studyapp.handbook.command_pages import INDEX, PAGES
from studyapp.handbook.running import run_page

GUIDE: Final = PAGES.parent / "guide.md"


def pages_to_run(only: tuple[str, ...] = ()) -> list[Path]:
    """Return the pages that are run, the guide first; of commands alone where some are named."""
    if only:
        return [PAGES / f"{name}.md" for name in only]
    return [GUIDE, *(path for path in sorted(PAGES.glob("*.md")) if path.stem != INDEX)]


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--only", multiple=True, help="A command whose page alone is run, as often as wanted."
)
def main(folder: Path, only: tuple[str, ...]) -> None:
    """Run the guide in FOLDER, and then the examples of all commands.

    With --only, FOLDER is one that the guide has been run in before.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not only and any(folder.iterdir()):
        raise InputError("the folder is not empty", where=folder, remedy="Name one that is")
    for path in pages_to_run(only):
        before = path.read_text(encoding="utf-8")
        after = run_page(before, folder.resolve(), on_block=click.echo)
        if after != before:
            write_text(path, after)
            click.echo(f"Wrote {path}")


if __name__ == "__main__":
    main()
