"""What a page is made of: plain data that the template only lays out."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

from markupsafe import Markup

Row = TypeVar("Row")


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One table cell.

    Attributes
    ----------
    text : str
        As the page shows it.
    value : float or None
        The number behind the text: rows are sorted by it, and files hold it; None for words.
    best, second : bool
        Whether it is the best of its kind, shown bold, or the second best, underlined.
    """

    text: str
    value: float | None = None
    best: bool = False
    second: bool = False


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table whose caption stands alone.

    Attributes
    ----------
    caption : str
        What the table shows.
    header : tuple of str
        Column headings; the first column heads the rows.
    rows : tuple of tuple of Cell
        As many cells per row as there are headings.
    groups : tuple of (str, int)
        Headings over several columns, with how many they span; empty for none.
    text_columns : int
        How many columns, from the left, hold text; the others hold numbers.
    notes : tuple of str
        Footnotes.
    name : str
        The table is also written as ``tables/<name>.tex`` and, unless `data` names another file,
        as ``tables/<name>.csv``; empty for the page alone.
    data : str
        File in the report's ``tables`` folder with the full data; empty for none.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    groups: tuple[tuple[str, int], ...] = ()
    text_columns: int = 1
    notes: tuple[str, ...] = ()
    name: str = ""
    data: str = ""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure whose caption stands alone.

    Attributes
    ----------
    svg : Markup
        The element that shows it on the page, with a text alternative.
    caption : str
        What it shows.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    name : str
        Its file in the report's ``figures`` folder, without the ending; empty for none.
    pdf : bytes
        What that file holds.
    """

    svg: Markup
    caption: str
    data: str = ""
    name: str = ""
    pdf: bytes = b""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading with what belongs under it, in order: paragraphs, then figures, then tables."""

    anchor: str
    heading: str
    paragraphs: tuple[str, ...] = ()
    bullets: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Page:
    """The whole report.

    Attributes
    ----------
    title : str
        The study's title.
    mark : str
        What must be said on every screen and every printed page; empty for real answers.
    mark_short : str
        The same in a word or two, for headings and captions.
    answer : tuple of str
        The sentences that answer the study's question.
    picture : Picture or None
        The first figure; None where nobody has answered.
    flow : str
        The participant flow in one line.
    sections : tuple of Section
        Everything after the first screen.
    """

    title: str
    mark: str
    mark_short: str
    answer: tuple[str, ...]
    picture: Picture | None
    flow: str
    sections: tuple[Section, ...]


def cells(*texts: str) -> tuple[Cell, ...]:
    """Return plain cells."""
    return tuple(Cell(text=text) for text in texts)


Column = tuple[str, Callable[[Row], Cell | str]]
"""A heading, and what a row has under it."""


def table_of(
    rows: Iterable[Row],
    *columns: Column[Row],
    caption: str,
    groups: tuple[tuple[str, int], ...] = (),
    notes: Iterable[str] = (),
    name: str = "",
    data: str = "",
) -> Table:
    """Return a table with a line for each of `rows`; see `Table` for all else.

    Parameters
    ----------
    rows : iterable
        What lines are about.
    *columns : (str, callable)
        From the left: the heading, and what gives a row's cell; those that give words, and stand
        before all that give cells, are columns of text.
    caption, groups, notes, name, data
        See `Table`.
    """
    found = [[cell(row) for _, cell in columns] for row in rows]
    texts = next((k for k, one in enumerate(found[0]) if isinstance(one, Cell)), 0) if found else 0
    return Table(
        caption=caption,
        header=tuple(heading for heading, _ in columns),
        rows=tuple(
            tuple(one if isinstance(one, Cell) else Cell(text=one) for one in row) for row in found
        ),
        groups=groups,
        text_columns=texts or (len(columns) if found else 1),
        notes=tuple(notes),
        name=name,
        data=data,
    )
