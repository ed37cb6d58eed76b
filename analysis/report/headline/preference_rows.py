"""Answers for one thing and against another, seen from the side that a reader asks about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TypeVar

from analysis.report import wording
from analysis.results.mismatch import MatchedCondition, MismatchResults
from analysis.results.net_preference import NetPreference
from analysis.results.pairwise import Comparison, PairwiseResults
from analysis.results.preference import Decision, Preference, Robustness
from analysis.stats.clustered_mean import Estimate
from analysis.stats.wilcoxon import Pooled

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
    recruited, attentive, n : int
        Participants who took part; those who are analysed; their answers.
    levels : tuple of int
        How many answered clearly one, slightly one, no difference, slightly and clearly other.
    win_share, everyone : Estimate
        Of the one: after exclusions, and when nobody is excluded.
    net : NetPreference
        For the one, in logits.
    decision : Decision
        What the report decides by.
    robustness, as_published
        Further tests, which have no direction.
    """

    label: str
    one: str
    other: str
    question: str
    recruited: int
    attentive: int
    n: int
    levels: tuple[int, ...]
    win_share: Estimate
    everyone: Estimate
    net: NetPreference
    decision: Decision
    robustness: Robustness
    as_published: Pooled

    @property
    def percentages(self) -> tuple[float, ...]:
        """The levels in percent of all answers; zeros without any."""
        return tuple(100 * level / max(self.n, 1) for level in self.levels)


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
        answers = sum(row.n for row in self.rows)
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
        turned = [_from(comparison, from_side) for comparison in members]
        if from_side is not None:
            rows = [replace(row, label=row.other) for row in turned]
            one, other, heading = wording.name(from_side), "the other", "against"
        else:
            rows = [replace(row, label=f"{row.one} against {row.other}") for row in turned]
            one, other, heading = "the first", "the second", "first against second"
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
        row.label: row.win_share.estimate
        for row in rows
        if row.question == wording.name(questions[0]) and row.n
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


def _from(comparison: Comparison, reference: str | None) -> PreferenceRow:
    row = _row(comparison, comparison.a, comparison.b, comparison.question)
    return _turned(row) if comparison.b == reference else row


def _own(condition: MatchedCondition) -> PreferenceRow:
    row = _row(condition, "own speech", "other speech", condition.question)
    return replace(row, label=wording.name(condition.condition))


def _row(found: Preference, one: str, other: str, question: str) -> PreferenceRow:
    return PreferenceRow(
        label="",
        one=wording.name(one),
        other=wording.name(other),
        question=wording.name(question),
        recruited=found.recruited,
        attentive=found.attentive,
        n=found.n,
        levels=tuple(found.counts.values()),
        win_share=found.win_share,
        everyone=found.without_exclusions.win_share,
        net=found.clmm,
        decision=found.decision,
        robustness=found.robustness,
        as_published=found.as_published,
    )


def _turned(row: PreferenceRow) -> PreferenceRow:
    return replace(
        row,
        one=row.other,
        other=row.one,
        levels=row.levels[::-1],
        win_share=row.win_share.turned(),
        everyone=row.everyone.turned(),
        net=replace(row.net, estimate=-row.net.estimate),
        decision=row.decision.turned(),
    )
