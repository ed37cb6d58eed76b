"""Results by question, and by set before that where there are sets, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeVar, cast

from analysis.report import wording
from analysis.results.grouping import ByQuestion

Result = TypeVar("Result")


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
