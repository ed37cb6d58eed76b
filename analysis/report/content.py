"""What sections are made of, which the template lays out: words, figures, and tables of cells."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, TypeVar

from markupsafe import Markup

from analysis.report import wording
from analysis.results.grouping import ConditionPlace, PairPlace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    secondary: str = "",
) -> Table:
    """Return a table with a line for each of `rows`; see `Table` for all else.

    Parameters
    ----------
    rows : iterable
        What lines are about.
    *columns : (str, callable)
        From the left: the heading, and what gives a row's cell; those that give words, and stand
        before all that give cells, are columns of text.
    caption, groups, notes, name, data, secondary
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
        secondary=secondary,
    )


CONDITION: Final[tuple[Column[ConditionPlace], ...]] = (
    ("question", lambda one: wording.heading(one.question)),
    ("condition", lambda one: wording.condition(one.condition)),
)


PAIR: Final[tuple[Column[PairPlace], ...]] = (
    ("question", lambda one: wording.heading(one.question)),
    ("first", lambda one: wording.condition(one.a)),
    ("second", lambda one: wording.condition(one.b)),
)


_MOST_BESIDE: Final = 3
"""Questions up to which a table shows them beside each other."""


def counted(value: float, text: str, *, best: bool = False, second: bool = False) -> Cell:
    """Return a cell that shows `text` and is sorted and filed by `value`, empty for NaN."""
    return Cell(
        text=text, value=None if math.isnan(value) else float(value), best=best, second=second
    )


def number_cell(value: float) -> Cell:
    """Return a number with two decimals."""
    return counted(value, wording.number(value))


def share_cell(value: float) -> Cell:
    """Return a share with two digits."""
    return counted(value, wording.share(value))


def p_cell(value: float) -> Cell:
    """Return a p value."""
    return counted(value, wording.p_value(value))


def count_cell(value: int) -> Cell:
    """Return a count."""
    return Cell(text=str(value), value=value)


def interval_cell(
    low: float, high: float, written: Callable[[float], str] = wording.number
) -> Cell:
    """Return an interval, sorted by its lower end; a dash where there is none."""
    return counted(low, "–" if math.isnan(low) else wording.between(written(low), written(high)))


def table_by_question(
    numbers: Mapping[tuple[str, str], Sequence[Cell]],
    heading: str,
    heads: Sequence[str],
    *,
    caption: str,
    name: str,
    data: str,
) -> Table:
    """Return a table with few questions beside each other, and more of them below each other.

    Parameters
    ----------
    numbers : mapping of (str, str) to sequence of Cell
        By what a row is about, as it is read, and question.
    heading : str
        Of the column that says what rows are about.
    heads : sequence of str
        Of the numbers.
    caption, name, data
        See `analysis.report.content.Table`.
    """
    questions = tuple(dict.fromkeys(question for _, question in numbers))
    if len(questions) > _MOST_BESIDE:
        return Table(
            caption=caption,
            header=("question", heading, *heads),
            rows=tuple(
                (*cells(wording.heading(question), about), *found)
                for (about, question), found in numbers.items()
            ),
            text_columns=2,
            name=name,
            data=data,
        )
    none = cells(*["–"] * len(heads))
    return Table(
        caption=caption,
        header=(heading, *(head for _ in questions for head in heads)),
        groups=(("", 1), *((wording.heading(question), len(heads)) for question in questions)),
        rows=tuple(
            (
                Cell(text=about),
                *(cell for question in questions for cell in numbers.get((about, question), none)),
            )
            for about in dict.fromkeys(about for about, _ in numbers)
        ),
        name=name,
        data=data,
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
