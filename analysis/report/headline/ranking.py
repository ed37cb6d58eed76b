"""Rankings as DiffSHEG shows them, with mean ranks, first places and Plackett-Luce worths."""

from __future__ import annotations

from collections.abc import Sequence

from analysis.report.by_question import of
from analysis.report.content import Picture, Section
from analysis.report.figures.ranking_figures import first_share_pictures, place_pictures
from analysis.report.headline.ranking_tables import place_table, posthoc_table, rank_table
from analysis.report.headline.strengths import (
    contrasts_table,
    standings,
    standings_table,
    strength_pictures,
)
from analysis.report.headline.words import in_set, of_set, suffix, why_no_figure
from analysis.report.subject import Subject
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.stats.clustered_mean import LEVEL

_DATA = "conditions.csv"


def ranking_sections(results: RankingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject.mark, suffix(None if name is None else number))
        for number, name in enumerate(sets, start=1)
    )


def _section(results: RankingResults, name: str | None, mark: str, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    worths = of(results.plackett_luce, name)
    reason = why_no_figure(
        answers=sum(c.n for c in conditions),
        participants=max(c.mean_rank.participants for c in conditions),
        tied=_all_tied(conditions),
    )
    contrasts = [c for c in results.contrasts if c.set == name]
    posthoc = [c for c in results.posthoc if c.set == name]
    caption = (
        f"{of_set(name)}Plackett–Luce worths of the rankings after exclusions (ties included), on "
        "a log scale on which they add up to zero, and the ranks that each condition may have at "
        f"{LEVEL:.0%}."
    )
    return Section(
        anchor=f"headline{end}",
        heading=in_set(name, "How the conditions were ranked"),
        paragraphs=(reason,) if reason else (),
        pictures=() if reason else _pictures(results, conditions, name, mark, end),
        tables=(
            rank_table(
                conditions,
                of(results.kendall_w, name),
                of(results.friedman, name),
                name=f"ranks{end}",
                data=_DATA,
            ),
            place_table(conditions, name=f"places{end}", data=_DATA),
            standings_table(
                worths,
                what="worth",
                caption=caption,
                name=f"worths{end}",
                data="plackett_luce.csv",
            ),
            *(
                (
                    contrasts_table(
                        contrasts,
                        worths,
                        what="worths",
                        name=f"contrasts{end}",
                        data="contrasts.csv",
                    ),
                )
                if contrasts
                else ()
            ),
            *(
                (posthoc_table(posthoc, name=f"posthoc{end}", data="posthoc.csv"),)
                if posthoc
                else ()
            ),
        ),
    )


def _pictures(
    results: RankingResults,
    conditions: Sequence[RankedCondition],
    name: str | None,
    mark: str,
    end: str,
) -> tuple[Picture, ...]:
    fitted = of(results.plackett_luce, name)
    standing = {question: found for question, one in fitted.items() if (found := standings(one))}
    worths = (
        strength_pictures(
            standing,
            axis="worth, log scale",
            name=f"worths{end}",
            title="Plackett–Luce worths",
            caption=f"{of_set(name)}Plackett–Luce worths (ties included), on a log scale on which "
            f"they add up to zero, with {LEVEL:.0%} intervals one at a time, and the ranks that "
            "each condition may have.",
            data="plackett_luce.csv",
            mark=mark,
        )
        if standing
        else ()
    )
    return (
        *place_pictures(conditions, name=f"places{end}", data=_DATA, mark=mark),
        *first_share_pictures(conditions, name=f"first-places{end}", data=_DATA, mark=mark),
        *worths,
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
