"""Answers for one thing and against another, seen from the side that a reader asks about."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, TypeVar

from analysis.report import wording
from analysis.report.wording import why_no_figure
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import Comparison, MatchedCondition

PAIRS: Final = "comparisons.csv"
CONDITIONS: Final = "conditions.csv"

Placed = TypeVar("Placed", Comparison, MatchedCondition)


@dataclass(frozen=True, kw_only=True)
class PreferenceRow:
    """One question about one thing (`one`) against another (`other`).

    Attributes
    ----------
    label : str
        Names the row beside the others of its group.
    one, other : str
        What it is about, for reading.
    found : Comparison or MatchedCondition
        What the answers say for the one.
    """

    label: str
    one: str
    other: str
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
    data : str
        File in the report's ``tables`` folder with all that is known of them.
    rows : tuple of PreferenceRow
        By question, emotion first as in AMUSE's Figure 6, and within it by win share on the first
        question.
    """

    set: str | None
    one: str
    other: str
    heading: str
    data: str
    rows: tuple[PreferenceRow, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The rows' labels, in order."""
        return tuple(dict.fromkeys(row.label for row in self.rows))

    @property
    def questions(self) -> tuple[str, ...]:
        """What was asked, in order."""
        return tuple(dict.fromkeys(row.found.question for row in self.rows))

    @property
    def why_no_figure(self) -> str:
        """Why nothing is drawn; '' where there is something to see."""
        answers = sum(row.found.n for row in self.rows)
        is_tied = answers == sum(row.levels[2] for row in self.rows)
        return why_no_figure(
            answers=answers,
            participants=max(row.found.attentive for row in self.rows),
            tied=f"Every one of the {answers} answers is “no difference”: nobody preferred "
            "anything, so there is nothing to draw and nothing to test."
            if is_tied
            else "",
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
    for members in _by_set(results.comparisons):
        side = reference_of(members, reference)
        rows = [_compared(comparison, side) for comparison in members]
        if side is None:
            found.append(_group("the first", "the second", "first against second", PAIRS, rows))
        else:
            found.append(_group(wording.condition(side), "the other", "against", PAIRS, rows))
    return tuple(found)


def _compared(comparison: Comparison, reference: str | None) -> PreferenceRow:
    found = comparison.turned() if comparison.b == reference else comparison
    one, other = wording.condition(found.a), wording.condition(found.b)
    label = f"{one} against {other}" if reference is None else other
    return PreferenceRow(label=label, one=one, other=other, found=found)


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
    one, other = "own speech", "other speech"
    return tuple(
        _group(
            one,
            other,
            "condition",
            CONDITIONS,
            [
                PreferenceRow(
                    label=wording.condition(own.condition), one=one, other=other, found=own
                )
                for own in members
            ],
        )
        for members in _by_set(results.conditions)
    )


def _by_set(members: Sequence[Placed]) -> Iterator[list[Placed]]:
    return (list(inside) for _, inside in groupby(members, key=lambda one: one.set))


def _group(
    one: str, other: str, heading: str, data: str, rows: Sequence[PreferenceRow]
) -> PreferenceGroup:
    questions = dict.fromkeys(row.found.question for row in rows)
    ordered = sorted(questions, key=lambda question: "emotion" not in question)
    shares = {
        row.label: row.found.win_share.estimate
        for row in rows
        if row.found.question == ordered[0] and row.found.n
    }
    return PreferenceGroup(
        set=rows[0].found.set,
        one=one,
        other=other,
        heading=heading,
        data=data,
        rows=tuple(
            sorted(
                rows,
                key=lambda row: (
                    ordered.index(row.found.question),
                    -shares.get(row.label, -1.0),
                ),
            )
        ),
    )
