"""Preferences as AMUSE shows them, and what several conditions allow beyond that.

Pairwise comparisons, and the same motion with its own and with other speech.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final

from analysis.report import wording
from analysis.report.content import Picture, Section, Table, headline_section
from analysis.report.figures.bars import Bar, Part, Won, bar_pictures, matrix_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import FIVE, Scale
from analysis.report.figures.svg import About
from analysis.report.sections.preference_rows import (
    PreferenceGroup,
    PreferenceRow,
    levels,
    mismatch_groups,
    pairwise_groups,
)
from analysis.report.sections.preference_tables import (
    counts_table,
    further_table,
    sums_table,
    win_share_table,
)
from analysis.report.sections.strengths import (
    contrasts_table,
    standings_table,
    strength_pictures,
    strongest_first,
)
from analysis.report.subject import Subject
from analysis.report.wording import share_words, suffix
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import Comparison
from analysis.results.strengths import Strengths
from analysis.stats.clustered_mean import LEVEL

MOST_BARS: Final = 15
"""Comparisons up to which each has its bar; more of them are shown as a matrix."""

SIGNIFICANCE: Final = 0.05

_SHARES: Final = Scale(
    limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share", line=0.5
)


def pairwise_sections(results: PairwiseResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set.

    Parameters
    ----------
    results : PairwiseResults
        What was found.
    subject : Subject
        Its reference, if it has one, is what all other conditions are compared with.
    """
    return tuple(
        headline_section(
            group.set,
            end,
            "What was preferred",
            reason=group.why_no_figure,
            pictures=partial(_pictures, results, group, subject.mark, end),
            tables=(
                sums_table(group, name="preferences"),
                win_share_table(group),
                counts_table(group),
                further_table(group),
                *_strength_tables(results, group),
            ),
        )
        for number, group in enumerate(pairwise_groups(results, subject.reference), start=1)
        for end in (suffix(group.set, number),)
    )


def mismatch_sections(results: MismatchResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    return tuple(
        headline_section(
            group.set,
            end,
            "Whether the motion fits its own speech",
            reason=group.why_no_figure,
            paragraph="A win share of .5 is what a condition gets whose motion fits any speech as "
            "well as its own; a higher one says that its motion belongs to what is said.",
            pictures=partial(
                preference_pictures,
                group,
                _about(group, f"own-speech{end}", subject.mark),
            ),
            tables=(
                win_share_table(group),
                sums_table(group, name="own-speech"),
                counts_table(group),
                further_table(group),
            ),
        )
        for number, group in enumerate(mismatch_groups(results), start=1)
        for end in (suffix(group.set, number),)
    )


def _strength_tables(results: PairwiseResults, group: PreferenceGroup) -> tuple[Table, ...]:
    strengths = results.bradley_terry.of_set(group.set)
    if not strengths:
        return ()
    standing = standings_table(
        strengths,
        what="strength",
        caption=f"Bradley–Terry strengths over all comparisons (Davidson's "
        "ties, left-side term), in logits that add up to zero, and the ranks that each condition "
        f"may have at {LEVEL:.0%}. After exclusions.",
        name="strengths",
        data="bradley_terry.csv",
    )
    contrasts = [one for one in results.contrasts if one.set == group.set]
    if len({name for one in contrasts for name in (one.a, one.b)}) < 3:
        return (standing,)
    return standing, contrasts_table(contrasts, strengths, "strengths")


def _pictures(
    results: PairwiseResults, group: PreferenceGroup, mark: str, end: str
) -> tuple[Picture, ...]:
    bars = _about(group, f"preferences{end}", mark)
    if group.heading == "against":
        return preference_pictures(group, bars)
    strengths = results.bradley_terry.of_set(group.set)
    fitted = {
        question: strengths[question] for question in group.questions if question in strengths
    }
    comparisons = [one for one in results.comparisons if one.set == group.set]
    about = About(
        name=f"strengths{end}",
        title="Bradley–Terry strengths",
        caption=f"Bradley–Terry strengths over all comparisons (Davidson's "
        f"ties, left-side term), which add up to zero, with {LEVEL:.0%} intervals one at a time, "
        "and the ranks that each condition may have.",
        data="bradley_terry.csv",
        mark=mark,
    )
    return (
        *(
            preference_pictures(group, bars)
            if len(group.labels) <= MOST_BARS
            else _matrix(comparisons, fitted, group, mark, end)
        ),
        *strength_pictures(fitted, "strength in logits", about),
    )


def preference_pictures(group: PreferenceGroup, about: About) -> tuple[Picture, ...]:
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
        about,
    )


def _about(group: PreferenceGroup, name: str, mark: str) -> About:
    return About(
        name=name,
        title=f"Answers for {group.one} and for {group.other}",
        caption=f"Answers in %, around “no difference”: {group.one} to the left, {group.other} to "
        "the right; after exclusions; n: participants analysed. Right: win share of "
        f"{group.one} (preferences plus half of “no difference”) with its {LEVEL:.0%} interval, "
        "clustered by participant and segment; .5 means that neither is preferred.",
        data=group.data,
        mark=mark,
    )


def _bar(row: PreferenceRow | None) -> Bar:
    if row is None or not row.found.n:
        return Bar()
    percents = row.percentages
    return Bar(
        start=-(percents[0] + percents[1] + percents[2] / 2),
        parts=tuple(
            Part(
                percent=percent,
                colour=colour,
                hint=f"{level}: {count} of {row.found.n} answers ({percent:.0f}%)",
            )
            for percent, colour, count, level in zip(
                percents, FIVE, row.levels, levels(row.one, row.other), strict=True
            )
        ),
        beside=row.found.win_share,
        written=wording.share,
    )


def _matrix(
    comparisons: Sequence[Comparison],
    fitted: Mapping[str, Strengths],
    group: PreferenceGroup,
    mark: str,
    end: str,
) -> tuple[Picture, ...]:
    shares: dict[str, dict[tuple[str, str], Won]] = {name: {} for name in group.questions}
    for one in comparisons:
        if not one.n:
            continue
        decided = one.decision.p_holm < SIGNIFICANCE
        turned = one.win_share.turned()
        for pair, share in (((one.a, one.b), one.win_share), ((one.b, one.a), turned)):
            shares[one.question][pair] = Won(
                share=share.estimate, words=share_words(share), decided=decided
            )
    return matrix_pictures(
        shares,
        strongest_first(fitted, [name for one in comparisons for name in (one.a, one.b)]),
        About(
            name=f"win-share-matrix{end}",
            title="Win shares of every two conditions",
            caption=f"Win share of the row's condition against the column's "
            "(preferences plus half of “no difference”), after exclusions; columns are numbered "
            "as the rows, which stand in the order of their strengths. Bold: the test decides at "
            f"{SIGNIFICANCE:g} after Holm's correction. Intervals are in the table.",
            data=group.data,
            mark=mark,
        ),
    )
