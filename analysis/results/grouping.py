"""Answers by set, question and condition or pair, and the families of their tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np

from analysis.stats.multiple_testing import holm
from motion.arrays import Bools, Indices
from motion.errors import InputError

if TYPE_CHECKING:
    # Serving a study reads families, and need not wait for pandas.
    import pandas as pd

    from analysis.answers.table import AnswerTable


Result = TypeVar("Result")
ResultT = TypeVar("ResultT", covariant=True)


class Row(NamedTuple, Generic[Result]):
    """A result with its set and question; the set is '' without sets."""

    set: str
    question: str
    result: Result


@dataclass(frozen=True)
class ByQuestion(Generic[ResultT]):
    """Results by question, and by set if the table has sets.

    Attributes
    ----------
    results : mapping of (set or None, question) to result
        The set is None if the table has no sets.
    sets : tuple of str
        All sets, including those without results.
    """

    results: Mapping[tuple[str | None, str], ResultT] = field(default_factory=dict)
    sets: tuple[str, ...] = ()

    def rows(self) -> Iterator[Row[ResultT]]:
        """Yield every result with its set and question, in order."""
        for (set_name, question), result in self.results.items():
            yield Row(set_name or "", question, result)

    def of_set(self, name: str | None) -> dict[str, ResultT]:
        """Return the results of a set by question; of a table without sets, all of them."""
        return {
            question: result
            for (set_name, question), result in self.results.items()
            if set_name == name
        }

    def nested(self) -> Mapping[str, object]:
        """Return results by question, nested under their set if there are sets."""
        if not self.sets:
            return self.of_set(None)
        return {name: self.of_set(name) for name in self.sets}


@dataclass(frozen=True, kw_only=True)
class ConditionKey:
    """The subject of a result: one condition and one question.

    Attributes
    ----------
    set : str or None
        None if the table has no sets.
    condition, question : str
        Their names.
    """

    set: str | None
    condition: str
    question: str

    @property
    def names(self) -> tuple[str, ...]:
        """The condition."""
        return (self.condition,)


@dataclass(frozen=True, kw_only=True)
class PairKey:
    """The subject of a result: two conditions, of which a appears first, and one question.

    Attributes
    ----------
    set : str or None
        None if the table has no sets.
    a, b, question : str
        Their names.
    """

    set: str | None
    a: str
    b: str
    question: str

    @property
    def names(self) -> tuple[str, ...]:
        """Both conditions."""
        return self.a, self.b


ResultKey = ConditionKey | PairKey

Tested = TypeVar("Tested", bound="ConditionKey | PairKey")


def split_by_question(
    table: AnswerTable, answers: pd.DataFrame
) -> Iterator[tuple[str | None, str, pd.DataFrame]]:
    """Yield set, question and answers, in the order of the table; the set is None without sets."""
    sets, questions = answers["set"].to_numpy(object), answers["question"].to_numpy(object)
    for name in table.sets:
        for question in table.questions:
            rows = (sets == name) & (questions == question)
            if rows.any():
                yield name if table.has_sets else None, question, answers[rows]


def by_question(
    table: AnswerTable, answers: pd.DataFrame, result: Callable[[pd.DataFrame], Result]
) -> ByQuestion[Result]:
    """Return a result for each question, and for each set if there are sets."""
    parts = split_by_question(table, answers)
    return as_by_question(table, {(name, question): result(part) for name, question, part in parts})


def as_by_question(
    table: AnswerTable, results: Mapping[tuple[str | None, str], Result]
) -> ByQuestion[Result]:
    """Return results by set and question together with the table's sets."""
    return ByQuestion(results, table.sets if table.has_sets else ())


def split_by_key(
    table: AnswerTable, answers: pd.DataFrame
) -> Iterator[tuple[ResultKey, pd.DataFrame]]:
    """Yield every condition or pair of conditions with its answers, question by question."""
    for set_name, question, part in split_by_question(table, answers):
        shown = np.stack(list(shown_codes(part).values()))
        for codes_of_key in np.unique(shown, axis=1).T:
            if codes_of_key.min() < 0:
                continue
            names = [table.conditions[code] for code in codes_of_key]
            rows = (shown == codes_of_key[:, None]).all(axis=0)
            yield (
                (
                    PairKey(set=set_name, a=names[0], b=names[1], question=question)
                    if len(names) == 2
                    else ConditionKey(set=set_name, condition=names[0], question=question)
                ),
                part[rows],
            )


def codes(answers: pd.DataFrame, column: str) -> Indices:
    """Return a column of names as numbers from 0."""
    return np.asarray(answers[column].cat.codes, np.intp)


def shown_codes(answers: pd.DataFrame) -> dict[str, Indices]:
    """Return the code of each answer's condition; for pairs those of both, a before b."""
    if "left" not in answers:
        return {"condition": codes(answers, "condition")}
    left, right = codes(answers, "left"), codes(answers, "right")
    return {"a": np.minimum(left, right), "b": np.maximum(left, right)}


def is_on_right(answers: pd.DataFrame) -> Bools:
    """Return which answers had a (the own speech in a mismatch task) on the right."""
    if "left" in answers:
        return np.asarray(codes(answers, "right") < codes(answers, "left"))
    return np.asarray(answers["right_speech"] == "own", bool)


def count_participants(answers: pd.DataFrame) -> int:
    """Return the number of participants who gave the answers."""
    return len(np.unique(codes(answers, "participant")))


def shown_conditions(answers: pd.DataFrame) -> tuple[str, ...]:
    """Return the conditions of the answers, in the order of the table."""
    names = answers["condition"].cat.categories
    return tuple(str(names[code]) for code in np.unique(codes(answers, "condition")))


FORMS = "all, by question, against=CONDITION, primary=CONDITION,CONDITION[,QUESTION]"


@dataclass(frozen=True, kw_only=True)
class Family:
    """The tests that decide, and whose p values are corrected together.

    Attributes
    ----------
    conditions : tuple of str
        Only tests about all of these decide: one for comparisons with a reference, two for a
        primary comparison; none for every test.
    question : str
        The only question whose tests decide; empty for all.
    by_question : bool
        Whether the tests of each question are corrected separately.
    """

    conditions: tuple[str, ...] = ()
    question: str = ""
    by_question: bool = False

    def contains(self, key: ResultKey) -> bool:
        """Return whether a test of this subject belongs to the family."""
        return set(self.conditions) <= set(key.names) and self.question in ("", key.question)

    def decide(self, results: Sequence[Tested], test_field: str = "") -> tuple[Tested, ...]:
        """Return results with their test's p, corrected by Holm's method, as `p_holm`.

        It is NaN for tests outside the family.

        Parameters
        ----------
        results : sequence
            The results that were tested.
        test_field : str
            The field of a result that holds its test; empty if the result is the test.
        """
        tests: list[Any] = [
            getattr(result, test_field) if test_field else result for result in results
        ]
        p_values = np.array([test.p_value for test in tests], np.float64)
        adjusted = np.full(len(tests), np.nan)
        members = [number for number, result in enumerate(results) if self.contains(result)]
        for question in dict.fromkeys(results[number].question for number in members):
            together = [
                number
                for number in members
                if not self.by_question or results[number].question == question
            ]
            adjusted[together] = holm(p_values[together].tolist())
        decided = [
            replace(test, p_holm=p) for test, p in zip(tests, adjusted.tolist(), strict=True)
        ]
        return tuple(
            replace(result, **{test_field: test}) if test_field else test
            for result, test in zip(results, decided, strict=True)
        )


EVERYTHING = Family()


def read_family(text: str, conditions: Sequence[str], questions: Sequence[str]) -> Family:
    """Return the family that `text` declares.

    Raises
    ------
    InputError
        If it has none of the forms, or names an unknown condition or question.
    """
    words = text.strip()
    if words in ("all", "by question"):
        return Family(by_question=words == "by question")
    form, _, listed = words.partition("=")
    names = tuple(name.strip() for name in listed.split(","))
    counts = {"against": (1,), "primary": (2, 3)}.get(form.strip(), ())
    if len(names) not in counts or not all(names):
        raise InputError(
            f"{text!r} is not a family of tests", where="family", remedy=f"Write one of: {FORMS}"
        )
    family = Family(conditions=names[:2], question="".join(names[2:]))
    for named, known in ((family.conditions, conditions), (names[2:], questions)):
        unknown = [name for name in named if name not in known]
        if unknown:
            raise InputError(
                f"the family names {unknown[0]}, which is not among {', '.join(known)}",
                where="family",
                remedy="Write one of these names",
            )
    return family
