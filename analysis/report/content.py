"""The parts of a report's page: sections with text, figures and tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from markupsafe import Markup

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
        The number behind the text, by which rows are sorted and which files hold; None for words.
    best, second : bool
        Whether it is the best of its kind, shown bold, or the second best, underlined.
    """

    text: str
    value: float | None = None
    best: bool = False
    second: bool = False


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table with a caption that stands alone.

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
        A short title under which the page folds the table away; empty if it is shown.
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
    """A figure with a caption that stands alone.

    Attributes
    ----------
    svg : Markup
        The element that shows it on the page, with a text alternative.
    caption : str
        What it shows.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    name : str
        Its files in the report's ``figures`` folder, without the extension; empty for none.
    figure : Figure or None
        The figure in these files.
    """

    svg: Markup
    caption: str
    data: str = ""
    name: str = ""
    figure: Figure | None = field(default=None, compare=False)


@dataclass(frozen=True, kw_only=True)
class FigureText:
    """The text around a figure.

    Attributes
    ----------
    name : str
        Of its file, and prefix of its ids: letters, digits and '-'.
    title, caption : str
        A few words, and the text under the figure.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    mark : str
        Written on top of the figure; empty for none.
    """

    name: str
    title: str
    caption: str
    data: str = ""
    mark: str = ""


@dataclass(frozen=True, kw_only=True)
class PlayablePair:
    """Two motions that play side by side, in `element`, with a table of their metrics if any."""

    element: Markup
    caption: str
    table: Table | None


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading and what is under it, in order: paragraphs, figures, motions, tables."""

    anchor: str
    heading: str
    paragraphs: tuple[str, ...] = ()
    bullets: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    playable: tuple[PlayablePair, ...] = ()
    tables: tuple[Table, ...] = ()


def number_cell(value: float, text: str, *, best: bool = False, second: bool = False) -> Cell:
    """Return a cell that shows `text` and has the value `value`, none for NaN."""
    return Cell(
        text=text, value=None if math.isnan(value) else float(value), best=best, second=second
    )


def headline_section(
    set_name: str | None,
    suffix: str,
    heading: str,
    *,
    no_figure: str,
    pictures: Callable[[], tuple[Picture, ...]],
    tables: Iterable[Table],
    paragraph: str = "",
) -> Section:
    """Return the main results of a set.

    Parameters
    ----------
    set_name : str or None
        Put before the heading and the captions; None without sets.
    suffix : str
        End of the names of the set's tables; see `analysis.report.wording.set_suffix`.
    heading : str
        What the section shows.
    no_figure : str
        Why no figure is drawn, which replaces figures and paragraph; '' if there are figures.
    pictures : callable
        Draws the figures.
    tables : iterable of Table
        The tables.
    paragraph : str, optional
        Text before the figures.
    """
    if set_name is not None:
        heading = f"Set {set_name}: {heading[:1].lower()}{heading[1:]}"
    prefix = "" if set_name is None else f"Set {set_name}. "
    text = no_figure or paragraph
    return Section(
        anchor=f"headline{suffix}",
        heading=heading,
        paragraphs=(text,) if text else (),
        pictures=()
        if no_figure
        else tuple(replace(item, caption=f"{prefix}{item.caption}") for item in pictures()),
        tables=tuple(
            replace(table, name=f"{table.name}{suffix}", caption=f"{prefix}{table.caption}")
            for table in tables
        ),
    )
