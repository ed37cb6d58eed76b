"""Results by question, and by set before that where there are sets, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, TypeVar, cast

from analysis.report import wording
from analysis.report.content import Cell, Table, cells
from analysis.results.grouping import ByQuestion

Result = TypeVar("Result")

_MOST_BESIDE: Final = 3
"""Questions up to which a table shows them beside each other."""


def each_question(
    found: ByQuestion[Result], sets: tuple[str, ...]
) -> Iterator[tuple[str, str, Result]]:
    """Give set ('' where there are none), question and result, in their order.

    Parameters
    ----------
    found : ByQuestion
        The results.
    sets : tuple of str
        The report's sets; () where it has none.
    """
    if not sets:
        for question, one in cast(Mapping[str, Result], found).items():
            yield "", question, one
        return
    for name, questions in cast(Mapping[str, Mapping[str, Result]], found).items():
        for question, one in questions.items():
            yield name, question, one


def of(found: ByQuestion[Result], name: str | None) -> Mapping[str, Result]:
    """Return the results of the set `name` by question; of all questions where it is None."""
    if name is None:
        return cast(Mapping[str, Result], found)
    return cast(Mapping[str, Mapping[str, Result]], found).get(name, {})


def question_name(of: str, question: str) -> str:
    """Return what a row about a question is called."""
    return wording.name(question) if not of else f"{wording.name(of)}: {wording.name(question)}"


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
