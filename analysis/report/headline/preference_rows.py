"""Answers for one thing and against another, seen from the side that a reader asks about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeVar

from analysis.report import wording
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.preference import Comparison, MatchedCondition

Placed = TypeVar("Placed", Comparison, MatchedCondition)


@dataclass(frozen=True, kw_only=True)
class PreferenceRow:
    """One question about one thing (`one`) against another (`other`).

    Attributes
    ----------
    label : str
        Names the row beside the others of its group.
    one, other, question : str
        What it is about, for reading.
    found : Comparison or MatchedCondition
        What the answers say for the one.
    """

    label: str
    one: str
    other: str
    question: str
    found: Comparison | MatchedCondition

    @property
    def levels(self) -> tuple[int, ...]:
        """How many answered clearly one, slightly one, no difference, slightly, clearly other."""
        return tuple(self.found.counts.values())

    @property
    def percentages(self) -> tuple[float, ...]:
        """The levels in percent of all answers; zeros without any."""
        return tuple(100 * level / max(self.found.n, 1) for level in self.levels)


@dataclass(frozen=True, kw_only=True)
class PreferenceGroup:
    """The rows of one set, which one figure shows together.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    one, other : str
        What the two sides of every row are called together.
    heading : str
        Of the column that names the rows.
    questions : tuple of str
        In order: emotion first, as in AMUSE's Figure 6.
    rows : tuple of PreferenceRow
        By question, and within it by win share.
    """

    set: str | None
    one: str
    other: str
    heading: str
    questions: tuple[str, ...]
    rows: tuple[PreferenceRow, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The rows' labels, in order."""
        return tuple(dict.fromkeys(row.label for row in self.rows))

    @property
    def all_tied(self) -> str:
        """A sentence where there are answers and all are 'no difference'; '' otherwise."""
        answers = sum(row.found.n for row in self.rows)
        if not answers or sum(row.levels[2] for row in self.rows) < answers:
            return ""
        return (
            f"Every one of the {answers} answers is “no difference”: nobody preferred anything, so "
            "there is nothing to draw and nothing to test."
        )


def levels(one: str, other: str) -> tuple[str, ...]:
    """Return what the five answers are called."""
    return (
        f"clearly {one}",
        f"slightly {one}",
        "no difference",
        f"slightly {other}",
        f"clearly {other}",
    )


def pairwise_groups(results: PairwiseResults, reference: str | None) -> tuple[PreferenceGroup, ...]:
    """Return the comparisons of each set, seen from the reference where there is one."""
    found = []
    for name, members in _by_set(results.comparisons):
        from_side = reference_of(members, reference)
        rows = [_compared(comparison, from_side) for comparison in members]
        if from_side is None:
            one, other, heading = "the first", "the second", "first against second"
        else:
            one, other, heading = wording.name(from_side), "the other", "against"
        found.append(_group(name, one, other, heading, [c.question for c in members], rows))
    return tuple(found)


def reference_of(comparisons: Sequence[Comparison], reference: str | None) -> str | None:
    """Return the condition from whose side comparisons are seen.

    Parameters
    ----------
    comparisons : sequence of Comparison
        Of one set.
    reference : str or None
        What the study says; without it, the condition that all comparisons have in common, the
        first one of two.
    """
    candidates = (comparisons[0].a, comparisons[0].b) if reference is None else (reference,)
    common = [name for name in candidates if all(name in (c.a, c.b) for c in comparisons)]
    return common[0] if common else None


def mismatch_groups(results: MismatchResults) -> tuple[PreferenceGroup, ...]:
    """Return the conditions of each set, seen from their own speech."""
    found = []
    for name, members in _by_set(results.conditions):
        rows = [_own(condition) for condition in members]
        questions = [condition.question for condition in members]
        found.append(_group(name, "own speech", "other speech", "condition", questions, rows))
    return tuple(found)


def _by_set(members: Sequence[Placed]) -> Iterable[tuple[str | None, list[Placed]]]:
    for name, inside in groupby(members, key=lambda one: one.set):
        yield name, list(inside)


def _group(
    name: str | None,
    one: str,
    other: str,
    heading: str,
    asked: Sequence[str],
    rows: Sequence[PreferenceRow],
) -> PreferenceGroup:
    questions = sorted(dict.fromkeys(asked), key=lambda question: "emotion" not in question)
    order = {wording.name(question): place for place, question in enumerate(questions)}
    shares = {
        row.label: row.found.win_share.estimate
        for row in rows
        if row.question == wording.name(questions[0]) and row.found.n
    }
    return PreferenceGroup(
        set=name,
        one=one,
        other=other,
        heading=heading,
        questions=tuple(questions),
        rows=tuple(
            sorted(rows, key=lambda row: (order[row.question], -shares.get(row.label, -1.0)))
        ),
    )


def _compared(comparison: Comparison, reference: str | None) -> PreferenceRow:
    found = comparison.turned() if comparison.b == reference else comparison
    one, other = wording.name(found.a), wording.name(found.b)
    return PreferenceRow(
        label=f"{one} against {other}" if reference is None else other,
        one=one,
        other=other,
        question=wording.name(found.question),
        found=found,
    )


def _own(condition: MatchedCondition) -> PreferenceRow:
    return PreferenceRow(
        label=wording.name(condition.condition),
        one="own speech",
        other="other speech",
        question=wording.name(condition.question),
        found=condition,
    )
