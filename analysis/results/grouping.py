"""Answers one question of one set at a time, and what a result is about."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.table import AnswerTable

Result = TypeVar("Result")
ByQuestion = Mapping[str, Result] | Mapping[str, Mapping[str, Result]]
"""Results by question; where the table has sets, by set and then by question."""


@dataclass(frozen=True, kw_only=True)
class ConditionPlace:
    """One condition and one question.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    condition, question : str
        What it is about.
    """

    set: str | None
    condition: str
    question: str

    @property
    def names(self) -> tuple[str, ...]:
        """The condition."""
        return (self.condition,)


@dataclass(frozen=True, kw_only=True)
class PairPlace:
    """Two conditions and one question: a against b, a being the one that appeared first.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    a, b, question : str
        What it is about.
    """

    set: str | None
    a: str
    b: str
    question: str

    @property
    def names(self) -> tuple[str, ...]:
        """Both conditions."""
        return self.a, self.b


Place = ConditionPlace | PairPlace


def parts(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[str, str, pd.DataFrame]]:
    """Give set, question and their answers, in the order of appearance; none without answers."""
    sets, questions = answers["set"].to_numpy(object), answers["question"].to_numpy(object)
    for name in table.sets:
        inside = sets == name
        for question in table.questions:
            chosen = inside & (questions == question)
            if chosen.any():
                yield name, question, answers[chosen]


def by_question(
    table: AnswerTable, answers: pd.DataFrame, result: Callable[[pd.DataFrame], Result]
) -> ByQuestion[Result]:
    """Return a result for each question, and for each set where there are sets."""
    found = {(name, question): result(part) for name, question, part in parts(table, answers)}
    return nested(table, found)


def nested(table: AnswerTable, found: Mapping[tuple[str, str], Result]) -> ByQuestion[Result]:
    """Return results by question, and by set before that where there are sets."""
    if not table.has_sets:
        return {question: one for (_, question), one in found.items()}
    return {
        name: {question: one for (of, question), one in found.items() if of == name}
        for name in table.sets
    }


def set_name(table: AnswerTable, name: str) -> str | None:
    """Return the name of a set, None where the table has none."""
    return name if table.has_sets else None


def codes(answers: pd.DataFrame, column: str) -> NDArray[np.intp]:
    """Return a column of names as numbers from 0."""
    return np.asarray(answers[column].cat.codes, np.intp)


def people(answers: pd.DataFrame) -> int:
    """Return how many participants gave the answers."""
    return len(np.unique(codes(answers, "participant")))


def shown_conditions(answers: pd.DataFrame) -> tuple[str, ...]:
    """Return the conditions that the answers are about, in the order of the table."""
    names = answers["condition"].cat.categories
    return tuple(str(names[place]) for place in np.unique(codes(answers, "condition")))
