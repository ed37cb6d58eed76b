"""The report's text from templates: paragraphs, tables (also as LaTeX) and captions.

In a template, functions return words (``share(x)``) and filters return table cells (``x | share``).
``tables.toml`` lists the columns of each table, ``figures.toml`` the text around each figure, and
``words`` holds the paragraphs.
"""

import math
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.resources import files
from itertools import accumulate, groupby
from typing import Any, Final, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined, Template, Undefined, UndefinedError

from analysis.report import wording
from analysis.report.content import Cell, FigureText, Table, number_cell
from analysis.stats.clustered_mean import LEVEL, TWO_WAY, Estimate
from motion.errors import listed

_MOST_QUESTIONS_ACROSS: Final = 3
"""Most questions that a table shows side by side."""

LONGEST: Final = 40
"""Most rows of a floating table; a longer one breaks across pages."""

Facts = dict[str, Any]
"""Values for a template, by the name that it uses."""


class _Column(NamedTuple):
    """A heading, the expression of a cell, a heading over several columns, and a list to repeat.

    The column is repeated for every ``item`` of the list; neighbours with the same list are
    repeated together.
    """

    heading: str
    cell: str
    group: str = ""
    repeat: str = ""


@dataclass(frozen=True, kw_only=True)
class _TableSpec:
    """A table of ``tables.toml``; see `Table` for what is not explained here.

    Attributes
    ----------
    columns : list of list
        The fields of each `_Column`.
    notes : list of str
        Templates; each may give several lines, or none.
    each_row : list of str
        Expressions; the value of each for a row becomes a note on ``about``.
    by_question : bool
        Whether a few questions are shown side by side; the first two columns are then the question
        and the row's subject.
    """

    caption: str
    columns: list[list[str]]
    name: str | None = None
    data: str = ""
    notes: Sequence[str] = ()
    each_row: Sequence[str] = ()
    about: str = "place_name(row)"
    secondary: str = ""
    by_question: bool = False


def paragraphs(macro: str, **facts: object) -> tuple[str, ...]:
    """Return the paragraphs that a macro makes of `facts`, without empty ones.

    Parameters
    ----------
    macro : str
        File in ``templates/words`` and macro, as ``methods.bullets``. An empty line ends a
        paragraph.
    **facts
        Values for the template.
    """
    file, name = macro.split(".")
    module = _environment().get_template(f"words/{file}.txt").make_module(facts)
    return tuple(_squeezed(getattr(module, name)().split("\n\n")))


def sentence(macro: str, **facts: object) -> str:
    """Return the text of a macro in one line, '' for none; see `paragraphs`."""
    return " ".join(paragraphs(macro, **facts))


def table(kind: str, rows: Iterable[object], **facts: object) -> Table:
    """Return a table of ``tables.toml`` with a line for each of `rows`.

    Parameters
    ----------
    kind : str
        The table's key there.
    rows : iterable
        The subject of each line, ``row`` in an expression.
    **facts
        Further values for its templates.
    """
    spec, rows = _table_specs()[kind], list(rows)
    facts |= {"rows": rows}
    columns = list(_repeated(spec.columns, facts))
    lines = [
        [_value(column.cell, known | {"row": row}) for column, known in columns] for row in rows
    ]
    filled = Table(
        caption=_filled(spec.caption, facts),
        header=tuple(_filled(column.heading, known) for column, known in columns),
        rows=tuple(
            tuple(cell if isinstance(cell, Cell) else Cell(text=cell) for cell in line)
            for line in lines
        ),
        groups=_groups([_filled(column.group, known) for column, known in columns]),
        text_columns=_text_columns(lines, len(columns)),
        notes=(*_notes(spec.notes, facts), *_notes_of_rows(spec, rows, facts)),
        name=kind if spec.name is None else _filled(spec.name, facts),
        data=_filled(spec.data, facts),
        secondary=spec.secondary,
    )
    return _questions_across(filled) if spec.by_question else filled


def figure_text(kind: str, *, suffix: str = "", **facts: object) -> FigureText:
    """Return the text around a figure of ``figures.toml``; its name ends in `suffix`."""
    spec = _toml("figures")[kind]
    return FigureText(
        name=f"{kind}{suffix}",
        **{key: _filled(template, facts) for key, template in spec.items()},
    )


def _repeated(columns: Sequence[Sequence[str]], facts: Facts) -> Iterator[tuple[_Column, Facts]]:
    """Yield each column as often as it is repeated, with the values for its templates."""
    for repeat, neighbours in groupby((_Column(*fields) for fields in columns), lambda c: c.repeat):
        together = list(neighbours)
        for item in _value(repeat, facts) if repeat else [None]:
            for column in together:
                yield column, facts | {"item": item}


def _text_columns(lines: Sequence[Sequence[object]], columns: int) -> int:
    """Return how many columns come before the first with numbers; all if none has numbers."""
    if not lines:
        return 1
    return next((k for k, cell in enumerate(lines[0]) if isinstance(cell, Cell)), 0) or columns


def _notes(templates: Sequence[str], facts: Facts) -> dict[str, None]:
    """Return every line of the notes once, in order."""
    filled = (_template(note).render(facts).split("\n") for note in templates)
    return dict.fromkeys(line for lines in filled for line in _squeezed(lines))


def _notes_of_rows(spec: _TableSpec, rows: Sequence[object], facts: Facts) -> tuple[str, ...]:
    return wording.merge_notes(
        (_value(spec.about, known), _value(note, known) or "")
        for known in (facts | {"row": row} for row in rows)
        for note in spec.each_row
    )


def _groups(labels: Sequence[str]) -> tuple[tuple[str, int], ...]:
    if not any(labels):
        return ()
    return tuple((label, len(list(columns))) for label, columns in groupby(labels))


def _questions_across(table: Table) -> Table:
    """Return a table with few questions side by side; more of them stay below each other."""
    questions = tuple(dict.fromkeys(row[0].text for row in table.rows))
    if len(questions) > _MOST_QUESTIONS_ACROSS:
        return table
    cells = {(row[1].text, row[0].text): row[2:] for row in table.rows}
    headings = table.header[2:]
    missing = (Cell(text="–"),) * len(headings)
    return replace(
        table,
        header=(table.header[1], *headings * len(questions)),
        groups=(("", 1), *((question, len(headings)) for question in questions)),
        rows=tuple(
            (
                Cell(text=name),
                *(cell for question in questions for cell in cells.get((name, question), missing)),
            )
            for name in dict.fromkeys(name for name, _ in cells)
        ),
        text_columns=1,
    )


def _filled(text: str, facts: Facts) -> str:
    return " ".join(_squeezed([_template(text).render(facts)])) if "{" in text else text


def _squeezed(texts: Iterable[str]) -> list[str]:
    lines = (re.sub(r"[ \n]+", " ", text).strip(" ") for text in texts)
    return [line for line in lines if line]


def _value(expression: str, facts: Facts) -> Any:
    value = _expression(expression)(**facts)
    if isinstance(value, Undefined):
        raise UndefinedError(f"{expression} has no value")
    return value


@cache
def _template(text: str) -> Template:
    return _environment().from_string(text)


@cache
def _expression(text: str) -> Any:
    return _environment().compile_expression(text, undefined_to_none=False)


def template_file(name: str) -> str:
    """Return the text of a file in the folder of templates."""
    return (files("analysis.report") / "templates" / name).read_text("utf-8")


@cache
def _toml(name: str) -> dict[str, dict[str, Any]]:
    return tomllib.loads(template_file(f"{name}.toml"))


@cache
def _table_specs() -> dict[str, _TableSpec]:
    return {kind: _TableSpec(**keys) for kind, keys in _toml("tables").items()}


def html(name: str, **facts: object) -> str:
    """Return a template as HTML, with every text of `facts` escaped."""
    return _html_environment().get_template(name).render(facts)


@cache
def _html_environment() -> Environment:
    return _templates(autoescape=True, keep_trailing_newline=True)


def _templates(**options: Any) -> Environment:
    return Environment(  # noqa: S701 - plain text, which the page escapes, if not said otherwise
        loader=PackageLoader("analysis.report", "templates"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        **options,
    )


@cache
def _environment() -> Environment:
    environment = _templates(
        finalize=lambda value: re.sub(r"\s*\n\s*", " ", value) if isinstance(value, str) else value
    )
    public = {name: value for name, value in vars(wording).items() if not name.startswith("_")}
    environment.globals |= public | {
        "listed": listed,
        "cell": number_cell,
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


def _cell(formatted: Callable[[float], str], value: float) -> Cell:
    return number_cell(value, formatted(value))


def _count_cell(value: int | None) -> Cell:
    return Cell(text="–" if value is None else str(value), value=value)


def _interval_cell(estimate: Any, formatted: Callable[[float], str] = wording.number) -> Cell:
    """Return the interval of an estimate, sorted by its lower end; a dash without one."""
    return number_cell(estimate.low, wording.interval(estimate, formatted) or "–")


def _estimate_cell(estimate: Estimate, formatted: Callable[[float], str] = wording.share) -> Cell:
    """Return an estimate with its interval if it has one."""
    interval = wording.interval(estimate, formatted)
    text = f"{formatted(estimate.estimate)}{wording.NO_BREAK}{interval}"
    return number_cell(estimate.estimate, text.rstrip(wording.NO_BREAK))


def booktabs(table: Table, *, remark: str = "") -> str:
    """Return a table as LaTeX that compiles whatever its cells contain.

    Parameters
    ----------
    table : Table
        The table; its best cells become bold, its second best underlined.
    remark : str, optional
        Put before the caption, for example that no person answered.
    """
    is_long = len(table.rows) > LONGEST
    ends = list(accumulate(span for _, span in table.groups))
    return (
        _latex_environment()
        .get_template("table.tex")
        .render(
            table=table,
            is_long=is_long,
            columns="l" * table.text_columns + "r" * (len(table.header) - table.text_columns),
            caption=f"{remark} {table.caption}".strip(),
            rules=[
                (end - span + 1, end)
                for (label, span), end in zip(table.groups, ends, strict=True)
                if label
            ],
        )
    )


@cache
def _latex_environment() -> Environment:
    # What is written is LaTeX, escaped by its own filter.
    environment = _templates(
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        keep_trailing_newline=True,
    )
    environment.filters["latex"] = as_latex
    return environment


def as_latex(text: str) -> str:
    """Return text for LaTeX, with every special character escaped."""
    return text.translate(_escapes())


@cache
def _escapes() -> dict[int, str]:
    return str.maketrans(tomllib.loads(template_file("latex.toml")))
