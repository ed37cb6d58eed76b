"""What sections are made of, which the template lays out: words, figures, and tables of cells."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from markupsafe import Markup

from analysis.report import wording

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    secondary : str
        What the table is, in a few words, where the page folds it away; empty where it is shown.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    groups: tuple[tuple[str, int], ...] = ()
    text_columns: int = 1
    notes: tuple[str, ...] = ()
    name: str = ""
    data: str = ""
    secondary: str = ""


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
        Its files in the report's ``figures`` folder, without the ending; empty for none.
    figure : Figure or None
        What is drawn in them.
    """

    svg: Markup
    caption: str
    data: str = ""
    name: str = ""
    figure: Figure | None = field(default=None, compare=False)


@dataclass(frozen=True, kw_only=True)
class About:
    """What stands around a figure.

    Attributes
    ----------
    name : str
        Of its file, and prefix of its ids: letters, digits and '-'.
    title : str
        What it is, in a few words.
    caption : str
        What stands under it.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    mark : str
        Written on top of it; empty for none.
    """

    name: str
    title: str
    caption: str
    data: str = ""
    mark: str = ""


@dataclass(frozen=True, kw_only=True)
class PlayablePair:
    """Two motions that play side by side, with what is known of them in a table below.

    Attributes
    ----------
    element : Markup
        In which they play.
    caption : str
        What they are.
    table : Table or None
        Their metrics; None where nothing was measured.
    """

    element: Markup
    caption: str
    table: Table | None


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading with what belongs under it, in order: paragraphs, figures, motions, tables."""

    anchor: str
    heading: str
    paragraphs: tuple[str, ...] = ()
    bullets: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    playable: tuple[PlayablePair, ...] = ()
    tables: tuple[Table, ...] = ()


def cells(*texts: str) -> tuple[Cell, ...]:
    """Return plain cells."""
    return tuple(Cell(text=text) for text in texts)


def counted(value: float, text: str, *, best: bool = False, second: bool = False) -> Cell:
    """Return a cell that shows `text` and is sorted and filed by `value`, empty for NaN."""
    return Cell(
        text=text, value=None if math.isnan(value) else float(value), best=best, second=second
    )


def headline_section(
    of: str | None,
    end: str,
    heading: str,
    *,
    reason: str,
    pictures: Callable[[], tuple[Picture, ...]],
    tables: Iterable[Table],
    paragraph: str = "",
) -> Section:
    """Return what was found in the set `of`.

    Where there is a `reason` for it, nothing is drawn, and the reason stands in place of the
    `paragraph`. Captions say which set it is, and names of tables end in `end`
    (`analysis.report.wording.suffix`).
    """
    which = "" if of is None else f"Set {of}. "
    said = reason or paragraph
    return Section(
        anchor=f"headline{end}",
        heading=wording.in_set(of, heading),
        paragraphs=(said,) if said else (),
        pictures=()
        if reason
        else tuple(replace(one, caption=f"{which}{one.caption}") for one in pictures()),
        tables=tuple(
            replace(one, name=f"{one.name}{end}", caption=f"{which}{one.caption}") for one in tables
        ),
    )
