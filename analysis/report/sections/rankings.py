"""Rankings as DiffSHEG shows them, with mean ranks, first places and Plackett-Luce worths."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final

from analysis.report import wording
from analysis.report.content import (
    CONDITION,
    PAIR,
    Cell,
    Picture,
    Section,
    Table,
    count_cell,
    counted,
    headline_section,
    interval_cell,
    number_cell,
    p_cell,
    share_cell,
    table_of,
)
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale, place_colours
from analysis.report.figures.svg import About
from analysis.report.sections.strengths import (
    contrasts_table,
    standings_table,
    strength_pictures,
)
from analysis.report.subject import Subject
from analysis.report.wording import (
    CLUSTERED,
    INTERVAL,
    between,
    gathered,
    place_of,
    suffix,
    why_no_figure,
)
from analysis.results.ranking import RankContrast, RankedCondition, RankingResults
from analysis.stats.clustered_mean import LEVEL
from analysis.stats.friedman import Concordance, Friedman

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
    worths = results.plackett_luce.of_set(name)
    contrasts = [c for c in results.contrasts if c.set == name]
    posthoc = [c for c in results.posthoc if c.set == name]
    caption = "Plackett–Luce worths"
    on_scale = "on a log scale on which they add up to zero"
    tables = [
        rank_table(
            conditions,
            results.kendall_w.of_set(name),
            results.friedman.of_set(name),
        ),
        place_table(conditions),
        standings_table(
            worths,
            what="worth",
            caption=f"{caption} of the rankings after exclusions (ties included), {on_scale}, and "
            f"the ranks that each condition may have at {LEVEL:.0%}.",
            name="worths",
            data=_WORTHS,
        ),
    ]
    if contrasts:
        tables.append(contrasts_table(contrasts, worths, "worths"))
    if posthoc:
        tables.append(posthoc_table(posthoc))
    about = About(
        name=f"worths{end}",
        title="Plackett–Luce worths",
        caption=f"{caption} (ties included), {on_scale}, with {LEVEL:.0%} intervals one at a time, "
        "and the ranks that each condition may have.",
        data=_WORTHS,
        mark=mark,
    )
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
            *place_pictures(conditions, name=f"places{end}", mark=mark),
            *strength_pictures(worths, "worth, log scale", about),
        ),
        tables=tables,
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
        [Row(wording.condition(one), f"n = {rankings[one]}") for one in names],
        dict(zip(map(ordinal, range(1, places + 1)), place_colours(places), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of rankings"),
        Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
        About(
            name=name,
            title="How often each condition came to each place",
            caption="How often each condition came to each place, in % of its n rankings, the "
            "first place on the left; tied conditions share their places; after exclusions. "
            f"Right: mean rank (1 is best) with its {LEVEL:.0%} interval, clustered by participant "
            "and segment. Intervals of the shares of first places are in the table.",
            data=_DATA,
            mark=mark,
        ),
    )


def _bar(ranked: RankedCondition | None, places: int) -> Bar:
    if ranked is None or not ranked.n:
        return Bar()
    return Bar(
        parts=tuple(
            Part(
                percent=percent,
                colour=colour,
                hint=f"{ordinal(place)} in {percent:.0f}% of {ranked.n} rankings",
            )
            for (place, percent), colour in zip(
                ranked.rank_percent.items(), place_colours(places), strict=False
            )
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


def ordinal(place: int) -> str:
    """Return a place as '1st', '2nd', '3rd', '4th'."""
    ending = "th" if 10 < place % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th")
    return f"{place}{ending}"


def place_table(conditions: Sequence[RankedCondition]) -> Table:
    """Return how often each condition came to each place, in percent."""
    places = max(len(c.rank_percent) for c in conditions)
    return table_of(
        conditions,
        *CONDITION,
        ("n", lambda c: count_cell(c.n)),
        *((ordinal(place), partial(_percent, place)) for place in range(1, places + 1)),
        caption="How often each condition came to each place, in % of "
        "its n rankings after exclusions; tied conditions share their places.",
        name="places",
        data=_DATA,
    )


def _percent(place: int, ranked: RankedCondition) -> Cell:
    found = ranked.rank_percent.get(place)
    return Cell(text="–") if found is None else counted(found, wording.fixed(found, 1))


def rank_table(
    conditions: Sequence[RankedCondition],
    agreed: Mapping[str, Concordance],
    tested: Mapping[str, Friedman],
) -> Table:
    """Return mean ranks and shares of first places with their intervals."""
    return table_of(
        conditions,
        *CONDITION,
        ("n", lambda c: count_cell(c.n)),
        ("mean", lambda c: number_cell(c.mean_rank.estimate)),
        (INTERVAL, lambda c: interval_cell(c.mean_rank.low, c.mean_rank.high)),
        ("p", lambda c: p_cell(c.mean_rank.p_value)),
        ("share", lambda c: share_cell(c.first_share.estimate)),
        (INTERVAL, lambda c: interval_cell(c.first_share.low, c.first_share.high, wording.share)),
        ("p", lambda c: p_cell(c.first_share.p_value)),
        caption=f"Mean rank (1 is best) and share of first places, with "
        f"{LEVEL:.0%} intervals clustered by participant and segment ({CLUSTERED}), "
        "each tested against what chance "
        "gives; p is not corrected. After exclusions; n: rankings.",
        groups=(("", 3), ("mean rank", 3), ("first places", 3)),
        notes=(
            *gathered(
                (place_of(c), note)
                for c in conditions
                for note in (
                    c.remark,
                    c.mean_rank.reason and f"no interval of the mean rank: {c.mean_rank.reason}",
                    c.first_share.reason
                    and f"no interval of the first places: {c.first_share.reason}",
                )
            ),
            *(
                f"{wording.heading(question)}: {_concordance(one)}."
                for question, one in agreed.items()
            ),
            *(
                f"{wording.heading(question)}: Friedman's test over participants' mean ranks, "
                "which takes the segments as the only ones of interest: "
                f"{f'p is missing, {one.reason}' if one.reason else wording.p_is(one.p_value)}."
                for question, one in tested.items()
            ),
        ),
        name="ranks",
        data=_DATA,
    )


def posthoc_table(contrasts: Sequence[RankContrast]) -> Table:
    """Return every two conditions after Friedman's test, secondary."""
    return table_of(
        contrasts,
        *PAIR,
        ("n", lambda c: count_cell(c.n)),
        ("difference", lambda c: number_cell(c.difference)),
        ("p (Nemenyi)", lambda c: p_cell(c.nemenyi_p)),
        ("p (Conover)", lambda c: p_cell(c.conover_holm)),
        ("p (Wilcoxon)", lambda c: p_cell(c.wilcoxon_holm)),
        caption="Every two conditions after Friedman's test, secondary: "
        "difference of participants' mean ranks, below zero where the first is better. Nemenyi "
        "corrects for all pairs of its question; Conover's and Wilcoxon's p are corrected by Holm "
        "over them. These tests take the segments as the only ones of interest. n: participants "
        "who ranked all conditions.",
        notes=gathered((place_of(c), c.reason) for c in contrasts),
        name="posthoc",
        data="posthoc.csv",
        secondary="Tests after Friedman's",
    )


def _concordance(found: Concordance) -> str:
    if found.reason:
        return f"Kendall's W: {found.reason}"
    low, high = wording.share(found.low), wording.share(found.high)
    inside = "" if math.isnan(found.low) else f" {between(low, high)}"
    return (
        f"Kendall's W, the mean over segments, is {wording.share(found.estimate)}{inside}; of "
        f"participants' mean ranks {wording.share(found.overall)}"
    )
