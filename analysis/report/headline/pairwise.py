"""Pairwise comparisons as AMUSE shows them, and what several conditions allow beyond that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from analysis.report.by_question import of
from analysis.report.content import Picture, Section
from analysis.report.figures.matrix_figure import Won, matrix_pictures
from analysis.report.figures.preference_figure import preference_pictures
from analysis.report.headline.preference_rows import PreferenceGroup, pairwise_groups
from analysis.report.headline.preference_tables import (
    counts_table,
    further_table,
    sums_table,
    win_share_table,
)
from analysis.report.headline.strengths import (
    Standing,
    contrasts_table,
    standings,
    standings_table,
    strength_pictures,
)
from analysis.report.headline.words import in_set, of_set, share_words, suffix, why_no_figure
from analysis.report.subject import Subject
from analysis.results.pairwise import Comparison, PairwiseResults
from analysis.stats.clustered_mean import LEVEL

MOST_BARS: Final = 15
"""Comparisons up to which each has its bar; more of them are shown as a matrix."""

SIGNIFICANCE: Final = 0.05

_DATA: Final = "comparisons.csv"


def pairwise_sections(results: PairwiseResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set.

    Parameters
    ----------
    results : PairwiseResults
        What was found.
    subject : Subject
        Its reference, if it has one, is what all other conditions are compared with.
    """
    groups = pairwise_groups(results, subject.reference)
    numbers = range(1, len(groups) + 1)
    return tuple(
        _section(results, group, subject, None if group.set is None else number)
        for number, group in zip(numbers, groups, strict=True)
    )


def _section(
    results: PairwiseResults, group: PreferenceGroup, subject: Subject, number: int | None
) -> Section:
    end = suffix(number)
    strengths = of(results.bradley_terry, group.set)
    reason = why_no_figure(
        answers=sum(row.n for row in group.rows),
        participants=max(row.attentive for row in group.rows),
        tied=group.all_tied,
    )
    tables = [
        sums_table(group, name=f"preferences{end}", data=_DATA),
        win_share_table(group, name=f"win-shares{end}", data=_DATA),
        counts_table(group, name=f"counts{end}", data=_DATA),
        further_table(group, name=f"as-published{end}", data=_DATA),
    ]
    if strengths:
        caption = (
            f"{of_set(group.set)}Bradley–Terry strengths over all comparisons (Davidson's ties, "
            "left-side term), in logits that add up to zero, and the ranks that each condition "
            f"may have at {LEVEL:.0%}. After exclusions."
        )
        tables.append(
            standings_table(
                strengths,
                what="strength",
                caption=caption,
                name=f"strengths{end}",
                data="bradley_terry.csv",
            )
        )
    contrasts = [one for one in results.contrasts if one.set == group.set]
    if len(strengths) and len({name for one in contrasts for name in (one.a, one.b)}) > 2:
        tables.append(
            contrasts_table(
                contrasts,
                strengths,
                what="strengths",
                name=f"contrasts{end}",
                data="contrasts.csv",
            )
        )
    return Section(
        anchor=f"headline{end}",
        heading=in_set(group.set, "What was preferred"),
        paragraphs=(reason,) if reason else (),
        pictures=() if reason else _pictures(results, group, subject.mark, end),
        tables=tuple(tables),
    )


def _pictures(
    results: PairwiseResults, group: PreferenceGroup, mark: str, end: str
) -> tuple[Picture, ...]:
    star = group.heading == "against"
    bars = (
        preference_pictures(group, name=f"preferences{end}", data=_DATA, mark=mark)
        if star or len(group.labels) <= MOST_BARS
        else ()
    )
    if star:
        return bars
    fitted = of(results.bradley_terry, group.set)
    standing = {
        question: found
        for question in group.questions
        if question in fitted and (found := standings(fitted[question]))
    }
    comparisons = [one for one in results.comparisons if one.set == group.set]
    return (
        *bars,
        *_strengths(standing, group, mark, end),
        *_matrix(comparisons, standing, group, mark, end),
    )


def _strengths(
    standing: Mapping[str, Sequence[Standing]], group: PreferenceGroup, mark: str, end: str
) -> tuple[Picture, ...]:
    if not standing:
        return ()
    return strength_pictures(
        standing,
        axis="strength in logits",
        name=f"strengths{end}",
        title="Bradley–Terry strengths",
        caption=f"{of_set(group.set)}Bradley–Terry strengths over all comparisons (Davidson's "
        f"ties, left-side term), which add up to zero, with {LEVEL:.0%} intervals one at a time, "
        "and the ranks that each condition may have.",
        data="bradley_terry.csv",
        mark=mark,
    )


def _matrix(
    comparisons: Sequence[Comparison],
    standing: Mapping[str, Sequence[Standing]],
    group: PreferenceGroup,
    mark: str,
    end: str,
) -> tuple[Picture, ...]:
    shares: dict[str, dict[tuple[str, str], Won]] = {}
    for question in group.questions:
        found = shares[question] = {}
        for one in comparisons:
            if one.question == question and one.n:
                share, decided = one.win_share, one.decision.p_holm < SIGNIFICANCE
                words = share_words(share)
                found[one.a, one.b] = Won(share=share.estimate, words=words, decided=decided)
                words = share_words(share.turned())
                found[one.b, one.a] = Won(share=1 - share.estimate, words=words, decided=decided)
    names = dict.fromkeys(name for one in comparisons for name in (one.a, one.b))
    values = {one.condition: one.value for one in next(iter(standing.values()), ())}
    return matrix_pictures(
        shares,
        sorted(names, key=lambda name: -values.get(name, 0.0)),
        name=f"win-share-matrix{end}",
        title="Win shares of every two conditions",
        caption=f"{of_set(group.set)}Win share of the row's condition against the column's "
        "(preferences plus half of “no difference”), after exclusions; columns are numbered as "
        "the rows, which stand in the order of their strengths. Bold: the test decides at "
        f"{SIGNIFICANCE:g} after Holm's correction. Intervals are in the table.",
        data=_DATA,
        mark=mark,
    )
