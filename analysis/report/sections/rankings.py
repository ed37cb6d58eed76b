"""Rankings as DiffSHEG shows them, and the strengths of conditions, of rankings and of pairs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from analysis.report import wording
from analysis.report.content import About, Picture, Section, Table, headline_section
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.dots import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale, place_colours
from analysis.report.subject import Subject
from analysis.report.texts import about, table
from analysis.report.wording import (
    SIGNIFICANCE,
    number,
    ordinal,
    ranks,
    suffix,
    why_no_figure,
)
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.results.strengths import ConditionStrength, StrengthDifference, StrengthModel


def ranking_sections(results: RankingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject.mark, suffix(name, place))
        for place, name in enumerate(sets, start=1)
    )


def _section(results: RankingResults, name: str | None, mark: str, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    contrasts = [c for c in results.contrasts if c.set == name]
    posthoc = [c for c in results.posthoc if c.set == name]
    worths = results.plackett_luce.of_set(name)
    places = max(len(c.rank_percent) for c in conditions)
    agreed, tested = results.kendall_w.of_set(name), results.friedman.of_set(name)
    tables = [
        table("ranks", conditions, agreed=agreed, tested=tested),
        table("places", conditions, places=places, nan=math.nan),
        standings_table(worths, "worths"),
    ]
    if contrasts:
        tables.append(contrasts_table(contrasts, worths, "worths"))
    if posthoc:
        tables.append(table("posthoc", posthoc))
    told = about("worths", end=end, mark=mark)
    return headline_section(
        name,
        end,
        "How the conditions were ranked",
        reason=why_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.mean_rank.participants for c in conditions),
            tied=_all_tied(conditions),
        ),
        pictures=lambda: (
            *_place_pictures(conditions, end, mark),
            *strength_pictures(worths, "worth, log scale", told),
        ),
        tables=tables,
    )


def _place_pictures(
    conditions: Sequence[RankedCondition], end: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came to each place, mean ranks beside: a panel per question."""
    places = max(len(one.rank_percent) for one in conditions)
    by_place = {(one.condition, one.question): one for one in conditions}
    first = {
        c.condition: c.mean_rank.estimate
        for c in conditions
        if c.question == conditions[0].question
    }
    names = sorted(
        dict.fromkeys(c.condition for c in conditions), key=lambda one: first.get(one, places + 1)
    )
    rankings = {one: max(c.n for c in conditions if c.condition == one) for one in names}
    return bar_pictures(
        {
            question: [_bar(by_place.get((one, question)), places) for one in names]
            for question in dict.fromkeys(one.question for one in conditions)
        },
        [Row(wording.condition(one), f"n = {rankings[one]}") for one in names],
        dict(zip(map(ordinal, range(1, places + 1)), place_colours(places), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of rankings"),
        Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
        about("places", end=end, mark=mark),
    )


def _bar(ranked: RankedCondition | None, places: int) -> Bar:
    if ranked is None or not ranked.n:
        return Bar()
    named = zip(ranked.rank_percent.items(), place_colours(places), strict=False)
    return Bar(
        parts=tuple(
            Part(percent, colour, f"{ordinal(place)} in {percent:.0f}% of {ranked.n} rankings")
            for (place, percent), colour in named
        ),
        beside=ranked.mean_rank,
    )


def _all_tied(conditions: Sequence[RankedCondition]) -> str:
    """Return a sentence where every ranking ties all conditions."""
    middle = (1 + len(conditions[0].rank_percent)) / 2
    alike = all(
        c.mean_rank.estimate == middle and len({round(p, 9) for p in c.rank_percent.values()}) == 1
        for c in conditions
        if c.n
    )
    certain = all(c.mean_rank.standard_error in {0.0} or c.mean_rank.reason for c in conditions)
    if alike and certain:
        return (
            "Every ranking ties all conditions: nobody put one before another, so there is nothing "
            "to draw and nothing to test."
        )
    return ""


def strength_pictures(
    found: Mapping[str, StrengthModel], axis: str, told: About
) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    found : mapping of str to StrengthModel
        By question; those without a fit are left out, and without any nothing is drawn.
    axis : str
        What the values are.
    told : About
        What stands around the figure.
    """
    known = {question: one for question, one in found.items() if not one.reason and one.conditions}
    if not known:
        return ()
    rows = {question: {c.condition: c for c in one.conditions} for question, one in known.items()}
    order = strongest_first(known, [name for own in rows.values() for name in own])
    return dot_pictures(
        {question: [_dot(own.get(name)) for name in order] for question, own in rows.items()},
        [Row(wording.condition(name)) for name in order],
        Scale(label=axis, line=0.0),
        told,
    )


def strongest_first(found: Mapping[str, StrengthModel], names: Iterable[str]) -> list[str]:
    """Return each name once, by the strengths on the first question that has some."""
    first = next((one.conditions for one in found.values() if not one.reason), ())
    known = {c.condition: c.estimate for c in first if not math.isnan(c.estimate)}
    return sorted(dict.fromkeys(names), key=lambda name: -known.get(name, -math.inf))


def _dot(found: ConditionStrength | None) -> Dot:
    rank = ranks(found)
    below = f"rank {rank}" if rank != "–" else ""
    return dot_of(found, number, below=below, more=f", rank {rank}")


def standings_table(found: Mapping[str, StrengthModel], kind: str) -> Table:
    """Return values, errors and ranks by question, the strongest condition first.

    Parameters
    ----------
    found : mapping of str to StrengthModel
        By question.
    kind : {'strengths', 'worths'}
        Which of them.
    """
    rows = [
        (question, one)
        for question, fitted in found.items()
        for one in sorted(fitted.conditions, key=lambda c: (math.isnan(c.estimate), -c.estimate))
    ]
    return table(kind, rows, fitted=found)


def contrasts_table(
    contrasts: Sequence[StrengthDifference], fitted: Mapping[str, StrengthModel], what: str
) -> Table:
    """Return how much stronger the first of every two conditions is.

    Parameters
    ----------
    contrasts : sequence of StrengthDifference
        Of one set.
    fitted : mapping of str to StrengthModel
        What they are differences of, by question.
    what : str
        What those are called.
    """
    shared = any(_share_ranks(one, fitted[one.question]) for one in contrasts)
    return table("contrasts", contrasts, fitted=fitted, what=what, shared=shared)


def _share_ranks(one: StrengthDifference, fitted: StrengthModel) -> bool:
    """Tell whether a decided difference is between conditions whose ranks overlap."""
    first, second = (
        {
            rank
            for c in fitted.conditions
            if c.condition == name and c.best and c.worst
            for rank in range(c.best, c.worst + 1)
        }
        for name in one.names
    )
    return one.p_holm < SIGNIFICANCE and bool(first & second)
