"""What figures and tables say, for tests to compare with the results."""

import re
from collections.abc import Iterable
from functools import cache
from typing import cast

from bs4 import BeautifulSoup, Tag
from matplotlib.patches import Rectangle

from analysis.report.content import Picture, Section, Table

SCALE = ("very unnatural", "not realistic", "looks OK", "looks good", "looks great")


def drawn(picture: Picture, place: int = 0) -> Tag:
    """Return a figure's element: the wide one, or the narrow one at place 1."""
    found = _drawings(picture.svg)[place]
    assert isinstance(found, Tag)
    return found


@cache
def _drawings(svg: str) -> list[Tag]:
    return list(BeautifulSoup(svg, "html.parser")("svg"))


def words(picture: Picture) -> list[str]:
    """Return the texts of a figure in drawing order."""
    return [text.get_text() for text in drawn(picture)("text")]


def told(picture: Picture) -> str:
    """Return a figure's text alternative."""
    found = drawn(picture).desc
    assert found is not None
    return found.get_text()


def bar(picture: Picture, row: int) -> list[tuple[float, float]]:
    """Return the left end and the width of each part of a bar of the first panel."""
    assert picture.figure is not None
    parts = cast(list[Rectangle], picture.figure.axes[0].patches)
    return [
        (part.get_x(), part.get_width()) for part in parts if round(part.get_center()[1]) == row
    ]


def present(section: Section | None) -> Section:
    """Return a section that the report must have."""
    assert section is not None
    return section


def named_picture(section: Section, name: str) -> Picture:
    """Return one of a section's figures."""
    return next(picture for picture in section.pictures if picture.name == name)


def named_table(section: Section, name: str) -> Table:
    """Return one of a section's tables."""
    return next(table for table in section.tables if table.name == name)


def check_texts(sections: Iterable[Section]) -> None:
    """Require that no text is of a missing number, and that every cell has a header."""
    for section in sections:
        said = [cell.text for table in section.tables for row in table.rows for cell in row]
        said += [note for table in section.tables for note in table.notes]
        said += [told(picture) for picture in section.pictures]
        assert not any("nan" in re.split(r"\W", text.lower()) for text in said)
        for table in section.tables:
            assert {len(row) for row in table.rows} <= {len(table.header)}
            assert not table.groups or sum(span for _, span in table.groups) == len(table.header)
