"""What the report says, from templates: paragraphs, tables and captions.

In a template, functions give words (``share(x)``) and filters give cells of a table
(``x | share``). ``tables.toml`` says of each table what its columns are, and ``figures.toml`` what
stands around each figure; ``words`` holds the paragraphs.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.resources import files
from itertools import groupby
from typing import Any, Final, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined, Template, Undefined, UndefinedError

from analysis.report import wording
from analysis.report.content import About, Cell, Table, cells, counted
from analysis.stats.clustered_mean import LEVEL, TWO_WAY, Estimate
from motion.errors import listed

_MOST_BESIDE: Final = 3
"""Questions up to which a table shows them beside each other."""


class _Column(NamedTuple):
    """A heading, what a row (``one``) has under it, a heading over several, and what repeats it."""

    head: str
    cell: str
    group: str = ""
    each: str = ""


@dataclass(frozen=True, kw_only=True)
class _Spec:
    """A table of ``tables.toml``; see `Table` for what is not explained here.

    Attributes
    ----------
    columns : list of list
        Of each `_Column`: neighbours of one `each` are repeated together, for every ``item``.
    notes : list of str
        Each may make several lines, or none.
    each_row : list of str
        Expressions; what they give for a row is a note on ``about``, each note once.
    by_question : bool
        Whether few questions stand beside each other: the first two columns are the question, and
        what a row is about.
    """

    caption: str
    columns: list[list[str]]
    name: str | None = None
    data: str = ""
    notes: list[str] | None = None
    each_row: list[str] | None = None
    about: str = "place_of(one)"
    secondary: str = ""
    by_question: bool = False


def paragraphs(place: str, **facts: object) -> tuple[str, ...]:
    """Return the paragraphs that a macro of a template makes of `facts`; '' is none.

    Parameters
    ----------
    place : str
        File in ``templates/words`` and macro, as ``methods.bullets``. An empty line ends a
        paragraph.
    **facts
        What the template knows.
    """
    file, macro = place.split(".")
    words = _environment().get_template(f"words/{file}.txt").make_module(facts)
    text = getattr(words, macro)()
    return tuple(_squeezed(text.split("\n\n")))


def sentence(place: str, **facts: object) -> str:
    """Return what a macro of a template makes of `facts`, '' for nothing; see `paragraphs`."""
    return " ".join(paragraphs(place, **facts))


def table(kind: str, rows: Iterable[object], **facts: object) -> Table:
    """Return a table of ``tables.toml`` with a line for each of `rows`.

    Parameters
    ----------
    kind : str
        Its key there.
    rows : iterable
        What lines are about; an expression calls each of them ``one``.
    **facts
        What else its templates know.
    """
    spec, found = _specs("tables")[kind], list(rows)
    facts |= {"rows": found}
    columns = [
        (column, facts | {"item": item})
        for each, own in groupby((_Column(*one) for one in spec.columns), lambda one: one.each)
        for inside in (list(own),)
        for item in (_value(each, facts) if each else [None])
        for column in inside
    ]
    lines = [
        [_value(column.cell, known | {"one": one}) for column, known in columns] for one in found
    ]
    texts = next((k for k, c in enumerate(lines[0]) if isinstance(c, Cell)), 0) if lines else 0
    made = Table(
        caption=_filled(spec.caption, facts),
        header=tuple(_filled(column.head, known) for column, known in columns),
        rows=tuple(
            tuple(c if isinstance(c, Cell) else Cell(text=c) for c in line) for line in lines
        ),
        groups=_groups([_filled(column.group, known) for column, known in columns]),
        text_columns=texts or (len(columns) if lines else 1),
        notes=(*_notes(spec.notes or (), facts), *_each_row(spec, found, facts)),
        name=kind if spec.name is None else _filled(spec.name, facts),
        data=_filled(spec.data, facts),
        secondary=spec.secondary,
    )
    return _beside_each_other(made) if spec.by_question else made


def about(kind: str, *, end: str = "", mark: str = "", **facts: object) -> About:
    """Return what stands around a figure of ``figures.toml``; `end` is the end of its name."""
    told = _specs("figures")[kind]
    return About(
        name=f"{told.get('name', kind)}{end}",
        mark=mark,
        **{key: _filled(told.get(key, ""), facts) for key in ("title", "caption", "data")},
    )


def _notes(notes: Sequence[str], facts: dict[str, Any]) -> dict[str, None]:
    """Return every line of the notes once, in order."""
    made = (_template(note).render(facts).split("\n") for note in notes)
    return dict.fromkeys(line for lines in made for line in _squeezed(lines))


def _each_row(spec: _Spec, rows: Sequence[object], facts: dict[str, Any]) -> tuple[str, ...]:
    return wording.gathered(
        (_value(spec.about, known), _value(note, known) or "")
        for one in rows
        for known in (facts | {"one": one},)
        for note in spec.each_row or ()
    )


def _groups(labels: Sequence[str]) -> tuple[tuple[str, int], ...]:
    found = tuple((label, len(list(own))) for label, own in groupby(labels))
    return found if any(labels) else ()


def _beside_each_other(found: Table) -> Table:
    """Return few questions beside each other, and more of them below each other."""
    questions = tuple(dict.fromkeys(row[0].text for row in found.rows))
    if len(questions) > _MOST_BESIDE:
        return found
    numbers = {(row[1].text, row[0].text): row[2:] for row in found.rows}
    heads = found.header[2:]
    none = cells(*["–"] * len(heads))
    return replace(
        found,
        header=(found.header[1], *heads * len(questions)),
        groups=(("", 1), *((question, len(heads)) for question in questions)),
        rows=tuple(
            (
                Cell(text=name),
                *(c for question in questions for c in numbers.get((name, question), none)),
            )
            for name in dict.fromkeys(name for name, _ in numbers)
        ),
        text_columns=1,
    )


def _filled(text: str, facts: dict[str, Any]) -> str:
    if "{" not in text:
        return text
    [found] = _squeezed([_template(text).render(facts)]) or [""]
    return found


def _squeezed(texts: Iterable[str]) -> list[str]:
    lines = (re.sub(r"[ \n]+", " ", text).strip(" ") for text in texts)
    return [line for line in lines if line]


def _value(expression: str, facts: dict[str, Any]) -> Any:
    found = _expression(expression)(**facts)
    if isinstance(found, Undefined):
        raise UndefinedError(f"{expression} gives nothing")
    return found


@cache
def _template(text: str) -> Template:
    return _environment().from_string(text)


@cache
def _expression(text: str) -> Any:
    return _environment().compile_expression(text, undefined_to_none=False)


def template(name: str) -> str:
    """Return the text of a file beside the templates."""
    return (files("analysis.report") / "templates" / name).read_text("utf-8")


@cache
def _specs(name: str) -> dict[str, Any]:
    found = tomllib.loads(template(f"{name}.toml"))
    return {key: _Spec(**one) for key, one in found.items()} if name == "tables" else found


@cache
def _environment() -> Environment:
    environment = Environment(  # noqa: S701 - it makes plain text, which the page escapes
        loader=PackageLoader("analysis.report", "templates"),
        undefined=StrictUndefined,
        finalize=lambda value: re.sub(r"\s*\n\s*", " ", value) if isinstance(value, str) else value,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    known = {name: one for name, one in vars(wording).items() if not name.startswith("_")}
    environment.globals |= known | {
        "listed": listed,
        "cell": counted,
        "level": f"{LEVEL:.0%}",
        "TWO_WAY": TWO_WAY,
        "nan": math.nan,
    }
    environment.tests["known"] = lambda value: not math.isnan(value)
    environment.filters |= {
        "share": partial(_cell, wording.share),
        "number": partial(_cell, wording.number),
        "measured": lambda value, measure: _cell(wording.number_style(measure), value),
        "difference": lambda value, measure: _cell(wording.difference_style(measure), value),
        "p": partial(_cell, wording.p_value),
        "count": _count_cell,
        "interval": _interval_cell,
        "estimate": _estimate_cell,
        "condition": wording.condition,
        "name": wording.name,
    }
    return environment


def _cell(written: Callable[[float], str], value: float) -> Cell:
    return counted(value, written(value))


def _count_cell(value: int | None) -> Cell:
    return Cell(text="–" if value is None else str(value), value=value)


def _interval_cell(found: Any, written: Any = wording.number) -> Cell:
    """Return the interval of an estimate, sorted by its lower end; a dash where there is none."""
    low, high = found.low, found.high
    text = "–" if math.isnan(low) else wording.between(written(low), written(high))
    return counted(low, text)


def _estimate_cell(found: Estimate, written: Any = wording.share) -> Cell:
    """Return an estimate with its interval, where it has one."""
    text = f"{written(found.estimate)}{wording.NO_BREAK}{wording.interval(found, written)}"
    return counted(found.estimate, text.rstrip(wording.NO_BREAK))
