"""Rankings in tables: as DiffSHEG's Figure 7 in numbers, and their uncertainty."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

from analysis.report import wording
from analysis.report.content import Cell, Table, table_of
from analysis.report.headline.words import (
    CLUSTERED,
    CONDITION,
    INTERVAL,
    PAIR,
    between,
    count_cell,
    counted,
    gathered,
    interval_cell,
    number_cell,
    of_set,
    p_cell,
    place_of,
    share_cell,
)
from analysis.results.ranking import RankContrast, RankedCondition
from analysis.stats.clustered_mean import LEVEL
from analysis.stats.rankings.friedman import Friedman
from analysis.stats.rankings.kendall_w import Concordance


def ordinal(place: int) -> str:
    """Return a place as '1st', '2nd', '3rd', '4th'."""
    ending = "th" if 10 < place % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th")
    return f"{place}{ending}"


def place_table(conditions: Sequence[RankedCondition], *, name: str, data: str) -> Table:
    """Return how often each condition came to each place, in percent."""
    places = max(len(c.rank_percent) for c in conditions)
    return table_of(
        conditions,
        *CONDITION,
        ("n", lambda c: count_cell(c.n)),
        *((ordinal(place), partial(_percent, place)) for place in range(1, places + 1)),
        caption=f"{of_set(conditions[0].set)}How often each condition came to each place, in % of "
        "its n rankings after exclusions; tied conditions share their places.",
        name=name,
        data=data,
    )


def _percent(place: int, ranked: RankedCondition) -> Cell:
    found = ranked.rank_percent.get(place)
    return Cell(text="–") if found is None else counted(found, wording.fixed(found, 1))


def rank_table(
    conditions: Sequence[RankedCondition],
    agreed: Mapping[str, Concordance],
    tested: Mapping[str, Friedman],
    *,
    name: str,
    data: str,
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
        caption=f"{of_set(conditions[0].set)}Mean rank (1 is best) and share of first places, with "
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
        name=name,
        data=data,
    )


def posthoc_table(contrasts: Sequence[RankContrast], *, name: str) -> Table:
    """Return every two conditions after Friedman's test, secondary."""
    return table_of(
        contrasts,
        *PAIR,
        ("n", lambda c: count_cell(c.n)),
        ("difference", lambda c: number_cell(c.difference)),
        ("p (Nemenyi)", lambda c: p_cell(c.nemenyi_p)),
        ("p (Conover)", lambda c: p_cell(c.conover_holm)),
        ("p (Wilcoxon)", lambda c: p_cell(c.wilcoxon_holm)),
        caption=f"{of_set(contrasts[0].set)}Every two conditions after Friedman's test, secondary: "
        "difference of participants' mean ranks, below zero where the first is better. Nemenyi "
        "corrects for all pairs of its question; Conover's and Wilcoxon's p are corrected by Holm "
        "over them. These tests take the segments as the only ones of interest. n: participants "
        "who ranked all conditions.",
        notes=gathered((place_of(c), c.reason) for c in contrasts),
        name=name,
        data="posthoc.csv",
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
