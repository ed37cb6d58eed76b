"""Running the guide and the commands' examples, and inserting their output.

``python -m tools.handbook.guide FOLDER`` runs ``docs/guide.md`` in an empty FOLDER, then the
examples of ``docs/commands`` in the same FOLDER. Repeated runs print the same output, so that a
page changes only if the program did.
"""

from pathlib import Path
from typing import Final

import click

from motion.errors import InputError
from motion.files import write_text
from tools.handbook.command_pages import INDEX, PAGES
from tools.handbook.running import run_page

GUIDE: Final = PAGES.parent / "guide.md"


def pages_to_run(only: tuple[str, ...] = ()) -> list[Path]:
    """Return the pages to run: the guide first, or only the named commands' pages."""
    if only:
        return [PAGES / f"{name}.md" for name in only]
    return [GUIDE, *(path for path in sorted(PAGES.glob("*.md")) if path.stem != INDEX)]


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@click.option("--only", multiple=True, help="A command whose page alone is run; repeatable.")
@click.option(
    "--since", default="", help="A heading of the guide, such as '## Check', to continue at."
)
def main(folder: Path, only: tuple[str, ...], since: str) -> None:
    """Run the guide in FOLDER, and then the examples of all commands.

    With --only and --since, FOLDER is one in which the guide was run before.
    """
    try:
        _run(folder, only, since)
    except InputError as error:
        raise click.ClickException(str(error)) from error


def _run(folder: Path, only: tuple[str, ...], since: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    if not (only or since) and any(folder.iterdir()):
        raise InputError("the folder is not empty", where=folder, remedy="Name an empty one")
    for path in pages_to_run(only):
        before = path.read_text(encoding="utf-8")
        first = since if path == GUIDE else ""
        after = run_page(before, folder.resolve(), on_block=click.echo, since=first)
        if after != before:
            write_text(path, after)
            click.echo(f"Wrote {path}")


if __name__ == "__main__":
    main()
