"""Pages in Markdown: templates, tables, and generated parts of pages."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from motion.errors import InputError
from motion.files import write_text


def rendered(package: str, template: str, **facts: Any) -> str:
    """Return the page that a package's template renders from `facts`."""
    environment = Environment(
        loader=PackageLoader(package),
        undefined=StrictUndefined,
        autoescape=False,  # noqa: S701 - the page is Markdown, made of our own words
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(template).render(facts)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; its cells must not contain an unescaped ``|``."""
    lines = [f"| {' | '.join(cells)} |" for cells in (head, *rows)]
    return "\n".join([lines[0], f"|{'---|' * len(head)}", *lines[1:]])


def marks(part: str) -> tuple[str, str]:
    """Return the marks before and after a generated part."""
    return f"<!-- {part}: begin -->", f"<!-- {part}: end -->"


def with_part(page: str, part: str, text: str) -> str:
    """Return the page with `text` between the marks of a part.

    Raises
    ------
    InputError
        If the page has no such marks.
    """
    begin, end = marks(part)
    before, _, rest = page.partition(begin)
    _, mark, after = rest.partition(end)
    if not mark:
        raise InputError(
            "the page has no marks for the generated part", remedy=f"Add {begin} and {end}"
        )
    return f"{before}{begin}\n{text}\n{end}{after}"


def write_part(path: Path, part: str, text: str) -> None:
    """Put `text` between the marks of a part of the page `path`."""
    write_text(path, with_part(path.read_text("utf-8"), part, text))
