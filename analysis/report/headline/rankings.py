"""Rankings as DiffSHEG shows them, with mean ranks, first places and Plackett-Luce worths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from analysis.report import wording
from analysis.report.content import Picture, Section
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.ink import place_colours
from analysis.report.figures.panels import Row, Scale
from analysis.report.figures.svg import About
from analysis.report.headline.ranking_tables import ordinal, place_table, posthoc_table, rank_table
from analysis.report.headline.strengths import (
    contrasts_table,
    standings_table,
    strength_pictures,
)
from analysis.report.headline.words import (
    between,
    in_set,
    number,
    of_set,
    results_of,
    suffix,
    why_no_figure,
)
from analysis.report.subject import Subject
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.stats.clustered_mean import LEVEL

_DATA: Final = "conditions.csv"
_WORTHS: Final = "plackett_luce.csv"


def ranking_sections(results: RankingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject.mark, suffix(name, place))
        for place, name in enumerate(sets, start=1)
    )


def _section(results: RankingResults, name: str | None, mark: str, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    worths = results_of(results.plackett_luce, name)
    reason = why_no_figure(
        answers=sum(c.n for c in conditions),
        participants=max(c.mean_rank.participants for c in conditions),
        tied=_all_tied(conditions),
    )
    contrasts = [c for c in results.contrasts if c.set == name]
    posthoc = [c for c in results.posthoc if c.set == name]
    caption = f"{of_set(name)}Plackett–Luce worths"
    on_scale = "on a log scale on which they add up to zero"
    tables = [
        rank_table(
            conditions,
            results_of(results.kendall_w, name),
            results_of(results.friedman, name),
            name=f"ranks{end}",
            data=_DATA,
        ),
        place_table(conditions, name=f"places{end}", data=_DATA),
        standings_table(
            worths,
            what="worth",
            caption=f"{caption} of the rankings after exclusions (ties included), {on_scale}, and "
            f"the ranks that each condition may have at {LEVEL:.0%}.",
            name=f"worths{end}",
            data=_WORTHS,
        ),
    ]
    if contrasts:
        tables.append(contrasts_table(contrasts, worths, "worths", name=f"contrasts{end}"))
    if posthoc:
        tables.append(posthoc_table(posthoc, name=f"posthoc{end}"))
    about = About(
        name=f"worths{end}",
        title="Plackett–Luce worths",
        caption=f"{caption} (ties included), {on_scale}, with {LEVEL:.0%} intervals one at a time, "
        "and the ranks that each condition may have.",
        data=_WORTHS,
        mark=mark,
    )
    return Section(
        anchor=f"headline{end}",
        heading=in_set(name, "How the conditions were ranked"),
        paragraphs=(reason,) if reason else (),
        pictures=()
        if reason
        else (
            *place_pictures(conditions, name=f"places{end}", mark=mark),
            *strength_pictures(worths, "worth, log scale", about),
        ),
        tables=tuple(tables),
    )


def place_pictures(
    conditions: Sequence[RankedCondition], *, name: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came to each place, mean ranks beside: a panel per question.

    Parameters
    ----------
    conditions : sequence of RankedCondition
        Of one set; those with the best mean rank on the first question come first.
    name, mark
        See `analysis.report.figures.svg.About`.
    """
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
        [Row(wording.name(one), f"n = {rankings[one]}") for one in names],
        dict(zip(map(ordinal, range(1, places + 1)), place_colours(places), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of rankings"),
        Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
        About(
            name=name,
            title="How often each condition came to each place",
            caption=f"{of_set(conditions[0].set)}"
            "How often each condition came to each place, in % of its n rankings, the first "
            "place on the left; tied conditions share their places; after exclusions. Right: mean "
            f"rank (1 is best) with its {LEVEL:.0%} interval, clustered by participant and "
            "segment. Intervals of the shares of first places are in the table.",
            data=_DATA,
            mark=mark,
        ),
    )


def _bar(ranked: RankedCondition | None, places: int) -> Bar:
    if ranked is None or not ranked.n:
        return Bar()
    mean = ranked.mean_rank
    return Bar(
        parts=tuple(
            Part(
                percent=percent,
                colour=colour,
                hint=f"{ordinal(place)} in {percent:.0f} % of {ranked.n} rankings",
            )
            for (place, percent), colour in zip(
                ranked.rank_percent.items(), place_colours(places), strict=False
            )
        ),
        estimate=mean.estimate,
        low=mean.low,
        high=mean.high,
        words=number(mean.estimate),
        below="no interval" if mean.reason else between(number(mean.low), number(mean.high)),
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
