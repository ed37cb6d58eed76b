"""Rankings as DiffSHEG shows them, and strengths of conditions from rankings and from pairs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from analysis.report import wording
from analysis.report.content import FigureText, Picture, Section, Subject, Table, headline_section
from analysis.report.figures.bars import Bar, Part, bar_pictures, condition_bars
from analysis.report.figures.dots import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale, place_colours
from analysis.report.texts import figure_text, table
from analysis.report.wording import (
    SIGNIFICANCE,
    number,
    ordinal,
    ranks,
    reason_for_no_figure,
    set_suffix,
)
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.results.strengths import ConditionStrength, StrengthDifference, StrengthModel


def ranking_sections(results: RankingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject.mark, set_suffix(name, number))
        for number, name in enumerate(sets, start=1)
    )


def _section(results: RankingResults, set_name: str | None, mark: str, suffix: str) -> Section:
    conditions = [c for c in results.conditions if c.set == set_name]
    contrasts = [c for c in results.contrasts if c.set == set_name]
    posthoc = [c for c in results.posthoc if c.set == set_name]
    worths = results.plackett_luce.of_set(set_name)
    tables = [
        table("ranks", conditions, tested=results.friedman.of_set(set_name)),
        table("places", conditions, places=_place_count(conditions)),
        standings_table(worths, "worths"),
    ]
    if contrasts:
        tables.append(contrasts_table(contrasts, worths, "worths"))
    if posthoc:
        tables.append(table("posthoc", posthoc))
    text = figure_text("worths", suffix=suffix, mark=mark)
    return headline_section(
        set_name,
        suffix,
        "How the conditions were ranked",
        no_figure=reason_for_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.mean_rank.participants for c in conditions),
            tied=_reason_if_tied(conditions),
        ),
        pictures=lambda: (
            *_place_pictures(conditions, suffix, mark),
            *strength_pictures(worths, "worth, log scale", text),
        ),
        tables=tables,
    )


def _place_count(conditions: Sequence[RankedCondition]) -> int:
    return max(len(c.rank_percent) for c in conditions)


def _place_pictures(
    conditions: Sequence[RankedCondition], suffix: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came to each place, with mean ranks: a panel per question."""
    places = _place_count(conditions)
    mean_ranks = {
        c.condition: c.mean_rank.estimate
        for c in conditions
        if c.question == conditions[0].question
    }
    names = sorted(
        dict.fromkeys(c.condition for c in conditions),
        key=lambda name: mean_ranks.get(name, places + 1),
    )
    panels, rows = condition_bars(conditions, names, lambda c: _bar(c, places))
    return bar_pictures(
        panels,
        rows,
        dict(zip(map(ordinal, range(1, places + 1)), place_colours(places), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of rankings"),
        Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
        figure_text("places", suffix=suffix, mark=mark),
    )


def _bar(ranked: RankedCondition, places: int) -> Bar:
    coloured = zip(ranked.rank_percent.items(), place_colours(places), strict=False)
    return Bar(
        parts=tuple(
            Part(percent, colour, f"{ordinal(place)} in {percent:.0f}% of {ranked.n} rankings")
            for (place, percent), colour in coloured
        ),
        estimate=ranked.mean_rank,
    )


def _reason_if_tied(conditions: Sequence[RankedCondition]) -> str:
    """Return why there is no figure if every ranking ties all conditions, else ''."""
    middle = (1 + len(conditions[0].rank_percent)) / 2
    is_even = all(
        c.mean_rank.estimate == middle and len({round(p, 9) for p in c.rank_percent.values()}) == 1
        for c in conditions
        if c.n
    )
    is_certain = all(c.mean_rank.standard_error == 0 or c.mean_rank.reason for c in conditions)
    if is_even and is_certain:
        return (
            "Every ranking ties all conditions: nobody put one before another, so there is nothing "
            "to draw and nothing to test."
        )
    return ""


def strength_pictures(
    standings: Mapping[str, StrengthModel], axis: str, text: FigureText
) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    standings : mapping of str to StrengthModel
        By question; those without a fit are left out, and without any nothing is drawn.
    axis : str
        Label of the values.
    text : FigureText
        The text around the figure.
    """
    fitted = {
        question: fit for question, fit in standings.items() if not fit.reason and fit.conditions
    }
    if not fitted:
        return ()
    by_name = {
        question: {c.condition: c for c in fit.conditions} for question, fit in fitted.items()
    }
    order = strongest_first(fitted, [name for fit in by_name.values() for name in fit])
    return dot_pictures(
        {question: [_dot(fit.get(name)) for name in order] for question, fit in by_name.items()},
        [Row(wording.condition(name)) for name in order],
        Scale(label=axis, line=0.0),
        text,
    )


def strongest_first(standings: Mapping[str, StrengthModel], names: Iterable[str]) -> list[str]:
    """Return each name once, by the strengths on the first question that has some."""
    conditions = next((fit.conditions for fit in standings.values() if not fit.reason), ())
    strengths = {c.condition: c.estimate for c in conditions if not math.isnan(c.estimate)}
    return sorted(dict.fromkeys(names), key=lambda name: -strengths.get(name, -math.inf))


def _dot(standing: ConditionStrength | None) -> Dot:
    rank = ranks(standing)
    below = f"rank {rank}" if rank != "–" else ""
    return dot_of(standing, number, below=below, more=f", rank {rank}")


def standings_table(standings: Mapping[str, StrengthModel], kind: str) -> Table:
    """Return values, errors and ranks by question, the strongest condition first.

    Parameters
    ----------
    standings : mapping of str to StrengthModel
        By question.
    kind : {'strengths', 'worths'}
        What they are.
    """
    rows = [
        (question, standing)
        for question, fit in standings.items()
        for standing in sorted(fit.conditions, key=lambda c: (math.isnan(c.estimate), -c.estimate))
    ]
    return table(kind, rows, fitted=standings)


def contrasts_table(
    contrasts: Sequence[StrengthDifference],
    standings: Mapping[str, StrengthModel],
    kind: str,
    *,
    decisive: bool = True,
) -> Table:
    """Return how much stronger the first condition of every pair is.

    Parameters
    ----------
    contrasts : sequence of StrengthDifference
        Of one set.
    standings : mapping of str to StrengthModel
        What they are differences of, by question.
    kind : {'strengths', 'worths'}
        What those are.
    decisive : bool
        Whether the report decides by them.
    """
    shared = any(_share_ranks(contrast, standings[contrast.question]) for contrast in contrasts)
    return table(
        "contrasts",
        contrasts,
        fitted=standings,
        estimates=kind,
        shared=shared,
        decisive=decisive,
    )


def _share_ranks(contrast: StrengthDifference, standings: StrengthModel) -> bool:
    """Tell whether two significantly different conditions have overlapping ranks."""
    first, second = (
        {
            rank
            for c in standings.conditions
            if c.condition == name and c.best and c.worst
            for rank in range(c.best, c.worst + 1)
        }
        for name in contrast.names
    )
    return contrast.p_holm < SIGNIFICANCE and bool(first & second)
