"""What results are about: sets, questions, conditions and pairs, and families of their tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from analysis.stats.multiple_testing import holm
from motion.errors import InputError

if TYPE_CHECKING:
    # Serving a study reads families, and need not wait for pandas.
    import pandas as pd

    from analysis.answers.table import AnswerTable

Codes = NDArray[np.intp]

Result = TypeVar("Result")
ResultT = TypeVar("ResultT", covariant=True)


class Row(NamedTuple, Generic[Result]):
    """A result, and what it is about; no set is ''."""

    set: str
    question: str
    found: Result


@dataclass(frozen=True)
class ByQuestion(Generic[ResultT]):
    """Results by question, and by set where the table has sets.

    Attributes
    ----------
    found : mapping of (set or None, question) to result
        None where the table has no sets.
    sets : tuple of str
        All of them, those without results too.
    """

    found: Mapping[tuple[str | None, str], ResultT] = field(default_factory=dict)
    sets: tuple[str, ...] = ()

    def rows(self) -> Iterator[Row[ResultT]]:
        """Give every result with its place, in their order."""
        for (name, question), one in self.found.items():
            yield Row(name or "", question, one)

    def of_set(self, name: str | None) -> dict[str, ResultT]:
        """Return the results of a set by question; of a table without sets, all of them."""
        return {question: one for (of, question), one in self.found.items() if of == name}

    def nested(self) -> Mapping[str, object]:
        """Return results by question, and by set before that where there are sets."""
        if not self.sets:
            return self.of_set(None)
        return {name: self.of_set(name) for name in self.sets}


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

Tested = TypeVar("Tested", bound="ConditionPlace | PairPlace")


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
    return of_parts(table, found)


def of_parts(table: AnswerTable, found: Mapping[tuple[str, str], Result]) -> ByQuestion[Result]:
    """Return the results of each part of a table's answers; see `parts`."""
    return ByQuestion(
        {(set_name(table, name), question): one for (name, question), one in found.items()},
        table.sets if table.has_sets else (),
    )


def set_name(table: AnswerTable, name: str) -> str | None:
    """Return the name of a set, None where the table has none."""
    return name if table.has_sets else None


def codes(answers: pd.DataFrame, column: str) -> Codes:
    """Return a column of names as numbers from 0."""
    return np.asarray(answers[column].cat.codes, np.intp)


def shown(answers: pd.DataFrame) -> dict[str, Codes]:
    """Return which conditions each answer is about, by number: a pair of them, a before b, or one.

    Of a pair, a is the one that appeared first.
    """
    if "left" not in answers:
        return {"condition": codes(answers, "condition")}
    left, right = codes(answers, "left"), codes(answers, "right")
    return {"a": np.minimum(left, right), "b": np.maximum(left, right)}


def compared(answers: pd.DataFrame) -> Iterator[tuple[tuple[int, ...], NDArray[np.bool_]]]:
    """Give every condition, or pair of them, that answers are about, and which answers are."""
    found = np.stack(list(shown(answers).values()))
    for numbers in np.unique(found, axis=1).T:
        if numbers.min() >= 0:
            yield tuple(numbers.tolist()), np.asarray((found == numbers[:, None]).all(axis=0), bool)


def place_of(table: AnswerTable, of: str, question: str, numbers: tuple[int, ...]) -> Place:
    """Return what a result about a condition, or a pair of them, is about."""
    names = [table.conditions[number] for number in numbers]
    if len(names) == 2:
        return PairPlace(set=set_name(table, of), a=names[0], b=names[1], question=question)
    return ConditionPlace(set=set_name(table, of), condition=names[0], question=question)


def on_right(answers: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell where a, or of one motion with two speeches the video with its own, was on the right."""
    if "left" in answers:
        return np.asarray(codes(answers, "right") < codes(answers, "left"))
    return np.asarray(answers["right_speech"] == "own", bool)


def people(answers: pd.DataFrame) -> int:
    """Return how many participants gave the answers."""
    return len(np.unique(codes(answers, "participant")))


def shown_conditions(answers: pd.DataFrame) -> tuple[str, ...]:
    """Return the conditions that the answers are about, in the order of the table."""
    names = answers["condition"].cat.categories
    return tuple(str(names[place]) for place in np.unique(codes(answers, "condition")))


FORMS = "all, by question, against=CONDITION, primary=CONDITION,CONDITION[,QUESTION]"


@dataclass(frozen=True, kw_only=True)
class Family:
    """Which tests decide, and over which of them p values are corrected together.

    Attributes
    ----------
    text : str
        As it was declared.
    conditions : tuple of str
        Only tests about all of these decide: one for comparisons with a reference, two for a
        primary comparison; none for every test.
    question : str
        The only question whose tests decide; empty for all.
    by_question : bool
        Whether the tests of each question are corrected by themselves.
    """

    text: str = "all"
    conditions: tuple[str, ...] = ()
    question: str = ""
    by_question: bool = False

    def holds(self, place: Place) -> bool:
        """Tell whether a test of this is a member."""
        return set(self.conditions) <= set(place.names) and self.question in ("", place.question)

    def corrected(self, places: Sequence[Place], p_values: Sequence[float]) -> tuple[float, ...]:
        """Return p values corrected by Holm's method; NaN of tests that are no members.

        Parameters
        ----------
        places : sequence of Place
            What each test is about.
        p_values : sequence of float
            Of the tests.
        """
        corrected = np.full(len(places), np.nan)
        inside = [number for number, place in enumerate(places) if self.holds(place)]
        for question in dict.fromkeys(places[number].question for number in inside):
            own = [n for n in inside if not self.by_question or places[n].question == question]
            corrected[own] = holm([p_values[number] for number in own])
        return tuple(corrected.tolist())

    def decide(self, found: Sequence[Tested], by: str = "") -> tuple[Tested, ...]:
        """Return what was tested with its p corrected as `p_holm`; `by` names what of it tests."""
        tests: list[Any] = [getattr(one, by) if by else one for one in found]
        corrected = self.corrected(found, [test.p_value for test in tests])
        decided = [replace(test, p_holm=p) for test, p in zip(tests, corrected, strict=True)]
        return tuple(
            replace(one, **{by: test}) if by else test
            for one, test in zip(found, decided, strict=True)
        )


EVERYTHING = Family()


def read_family(text: str, conditions: Sequence[str], questions: Sequence[str]) -> Family:
    """Return the family that `text` declares.

    Raises
    ------
    InputError
        If it is of no form, or names a condition or question that there is not.
    """
    words = text.strip()
    if words in ("all", "by question"):
        return Family(text=words, by_question=words == "by question")
    form, _, names = words.partition("=")
    parts = tuple(part.strip() for part in names.split(","))
    wanted = {"against": (1,), "primary": (2, 3)}.get(form.strip(), ())
    if len(parts) not in wanted or not all(parts):
        raise InputError(
            f"{text!r} is not a family of tests", where="family", remedy=f"Write one of: {FORMS}"
        )
    about, question = parts[:2] if form.strip() == "primary" else parts, "".join(parts[2:])
    for name, known in ((about, conditions), ((question,) if question else (), questions)):
        unknown = [one for one in name if one not in known]
        if unknown:
            raise InputError(
                f"the family names {unknown[0]}, which is not among {', '.join(known)}",
                where="family",
                remedy="Write the name as the study does",
            )
    return Family(text=words, conditions=about, question=question)
