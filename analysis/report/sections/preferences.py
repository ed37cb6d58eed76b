"""Preferences as AMUSE shows them, and what several conditions allow beyond that.

Pairwise comparisons, and the same motion with its own and with other speech.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final, TypeVar

from analysis.report import wording
from analysis.report.content import About, Picture, Section, Table, headline_section
from analysis.report.figures.bars import Bar, Part, Won, bar_pictures, matrix_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import FIVE, Scale
from analysis.report.sections.rankings import (
    contrasts_table,
    standings_table,
    strength_pictures,
    strongest_first,
)
from analysis.report.subject import Subject
from analysis.report.texts import about, table
from analysis.report.wording import SIGNIFICANCE, share_words, suffix, why_no_figure
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import Comparison, MatchedCondition

MOST_BARS: Final = 15
"""Comparisons up to which each has its bar; more of them are shown as a matrix."""

_SHARES: Final = Scale(
    limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share", line=0.5
)

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

    @property
    def sides(self) -> tuple[float, ...]:
        """Percent for the one, for the other and for neither; NaN without any answers."""
        clearly, slightly, equal, less, least = self.percentages
        found = (clearly + slightly, less + least, equal)
        return found if self.found.n else (math.nan,) * 3


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
    ours, theirs = (f"clearly {one}", f"slightly {one}"), (f"slightly {other}", f"clearly {other}")
    return (*ours, "no difference", *theirs)


def pairwise_groups(results: PairwiseResults, reference: str | None) -> tuple[PreferenceGroup, ...]:
    """Return the comparisons of each set, seen from the reference where there is one."""
    found = []
    for members in _by_set(results.comparisons):
        side = reference_of(members, reference)
        rows = [_compared(comparison, side) for comparison in members]
        names = ("the first", "the second", "first against second")
        if side is not None:
            names = (wording.condition(side), "the other", "against")
        found.append(_group(names, "comparisons.csv", rows))
    return tuple(found)


def _compared(comparison: Comparison, reference: str | None) -> PreferenceRow:
    found = comparison.mirrored() if comparison.b == reference else comparison
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
            (one, other, "condition"),
            "conditions.csv",
            [
                PreferenceRow(label=wording.condition(c.condition), one=one, other=other, found=c)
                for c in members
            ],
        )
        for members in _by_set(results.conditions)
    )


def _by_set(members: Sequence[Placed]) -> Iterable[list[Placed]]:
    return (list(inside) for _, inside in groupby(members, key=lambda one: one.set))


def _group(
    names: tuple[str, str, str], data: str, rows: Sequence[PreferenceRow]
) -> PreferenceGroup:
    questions = dict.fromkeys(row.found.question for row in rows)
    ordered = sorted(questions, key=lambda question: "emotion" not in question)
    shares = {
        row.label: row.found.win_share.estimate
        for row in rows
        if row.found.question == ordered[0] and row.found.n
    }

    def place(row: PreferenceRow) -> tuple[int, float]:
        return ordered.index(row.found.question), -shares.get(row.label, -1.0)

    one, other, heading = names
    return PreferenceGroup(
        set=rows[0].found.set,
        one=one,
        other=other,
        heading=heading,
        data=data,
        rows=tuple(sorted(rows, key=place)),
    )


def pairwise_sections(results: PairwiseResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set; a reference is what all others are compared with."""
    return tuple(
        _pairwise_section(results, group, subject.mark, suffix(group.set, number))
        for number, group in enumerate(pairwise_groups(results, subject.reference), start=1)
    )


def _pairwise_section(
    results: PairwiseResults, group: PreferenceGroup, mark: str, end: str
) -> Section:
    strengths = results.bradley_terry.of_set(group.set)
    contrasts = [one for one in results.contrasts if one.set == group.set]

    def pictures() -> tuple[Picture, ...]:
        bars = (
            preference_pictures(group, about("preferences", end=end, mark=mark, group=group))
            if group.heading == "against" or len(group.labels) <= MOST_BARS
            else ()
        )
        if group.heading == "against":
            return bars
        fitted = {name: strengths[name] for name in group.questions if name in strengths}
        told = about("strengths", end=end, mark=mark)
        return (
            *(bars or _matrix(results, group, about("win-share-matrix", end=end, mark=mark))),
            *strength_pictures(fitted, "strength in logits", told),
        )

    few = len({name for one in contrasts for name in one.names}) < 3
    return headline_section(
        group.set,
        end,
        "What was preferred",
        reason=group.why_no_figure,
        pictures=pictures,
        tables=(
            *_tables(group, "preferences"),
            *([standings_table(strengths, "strengths")] if strengths else []),
            *([] if few or not strengths else [contrasts_table(contrasts, strengths, "strengths")]),
        ),
    )


def mismatch_sections(results: MismatchResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""

    def section(group: PreferenceGroup, end: str) -> Section:
        told = about("preferences", mark=subject.mark, group=group)
        sums, shares, *others = _tables(group, "own-speech")
        return headline_section(
            group.set,
            end,
            "Whether the motion fits its own speech",
            reason=group.why_no_figure,
            paragraph="A win share of .5 is what a condition gets whose motion fits any speech as "
            "well as its own; a higher one says that its motion belongs to what is said.",
            pictures=lambda: preference_pictures(group, replace(told, name=f"own-speech{end}")),
            tables=(shares, sums, *others),
        )

    return tuple(
        section(group, suffix(group.set, number))
        for number, group in enumerate(mismatch_groups(results), start=1)
    )


def _tables(group: PreferenceGroup, name: str) -> tuple[Table, ...]:
    names = levels(group.one, group.other)
    return (
        table("preferences", group.rows, group=group, name=name),
        *(
            table(kind, group.rows, group=group, levels=names)
            for kind in ("win-shares", "counts", "as-published")
        ),
    )


def preference_pictures(group: PreferenceGroup, told: About) -> tuple[Picture, ...]:
    """Draw answers as bars around 'no difference', win shares beside: AMUSE's Figure 6."""
    by_place = {(row.label, row.found.question): row for row in group.rows}
    panels = {
        question: [_bar(by_place.get((label, question))) for label in group.labels]
        for question in group.questions
    }
    sides = [
        abs(end)
        for bars in panels.values()
        for bar in bars
        for end in (bar.start, bar.start + sum(part.percent for part in bar.parts))
    ]
    reach = min(100, max(60, math.ceil(max(sides)) + 5))
    people = {
        label: max(row.found.attentive for row in group.rows if row.label == label)
        for label in group.labels
    }
    return bar_pictures(
        panels,
        [Row(label, f"n = {people[label]}") for label in group.labels],
        dict(zip(levels(group.one, group.other), FIVE, strict=True)),
        Scale(
            limits=(-reach, reach),
            ticks={-50: "50%", 0: "0", 50: "50%"},
            ends=(group.one.removeprefix("the "), group.other.removeprefix("the ")),
            line=0,
        ),
        _SHARES,
        told,
    )


def _bar(row: PreferenceRow | None) -> Bar:
    if row is None or not row.found.n:
        return Bar()
    percents = row.percentages
    named = zip(percents, FIVE, row.levels, levels(row.one, row.other), strict=True)
    return Bar(
        start=-(percents[0] + percents[1] + percents[2] / 2),
        parts=tuple(
            Part(percent, colour, f"{level}: {count} of {row.found.n} answers ({percent:.0f}%)")
            for percent, colour, count, level in named
        ),
        beside=row.found.win_share,
        written=wording.share,
    )


def _matrix(results: PairwiseResults, group: PreferenceGroup, told: About) -> tuple[Picture, ...]:
    comparisons = [one for one in results.comparisons if one.set == group.set and one.n]
    shares: dict[str, dict[tuple[str, str], Won]] = {name: {} for name in group.questions}
    for one in comparisons:
        for seen in (one, one.mirrored()):
            shares[one.question][seen.a, seen.b] = Won(
                seen.win_share.estimate,
                share_words(seen.win_share),
                one.decision.p_holm < SIGNIFICANCE,
            )
    strengths = results.bradley_terry.of_set(group.set)
    fitted = {name: strengths[name] for name in group.questions if name in strengths}
    names = [name for one in results.comparisons if one.set == group.set for name in one.names]
    return matrix_pictures(shares, strongest_first(fitted, names), told)
