"""What a page is made of: plain data that the template only lays out."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One table cell; `best` marks the highest of its kind by weight and by a sign."""

    text: str
    best: bool = False


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
    data : str
        File in the report's ``tables`` folder with the full data; empty for none.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    groups: tuple[tuple[str, int], ...] = ()
    text_columns: int = 1
    notes: tuple[str, ...] = ()
    data: str = ""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure whose caption stands alone."""

    svg: Markup
    caption: str
    data: str


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
