"""Ratings as the user study of Speech2UnifiedExpressions shows them, and every contrast."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from analysis.report.by_question import of
from analysis.report.content import Section
from analysis.report.figures.rating_figures import (
    contrast_pictures,
    cumulative_pictures,
    distribution_pictures,
)
from analysis.report.headline.rating_tables import (
    contrast_table,
    interval_table,
    model_table,
    score_table,
)
from analysis.report.headline.words import in_set, suffix, why_no_figure
from analysis.report.subject import Subject
from analysis.results.rating import RatedCondition, RatingResults

MOST_PAIRS: Final = 15
"""Pairs of conditions up to which their differences are drawn."""

_DATA: Final = "conditions.csv"


def rating_sections(results: RatingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set.

    Parameters
    ----------
    results : RatingResults
        What was found.
    subject : Subject
        Names the points of the scales.
    """
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject, suffix(None if name is None else number))
        for number, name in enumerate(sets, start=1)
    )


def _section(results: RatingResults, name: str | None, subject: Subject, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    contrasts = [c for c in results.contrasts if c.set == name]
    mark = subject.mark
    reason = why_no_figure(
        answers=sum(c.n for c in conditions),
        participants=max(c.participants for c in conditions),
        tied=_all_alike(conditions),
    )
    return Section(
        anchor=f"headline{end}",
        heading=in_set(name, "How the conditions were rated"),
        paragraphs=(reason,) if reason else (),
        pictures=()
        if reason
        else (
            *distribution_pictures(
                conditions, subject.scale_labels, name=f"ratings{end}", data=_DATA, mark=mark
            ),
            *cumulative_pictures(conditions, name=f"cumulative{end}", data=_DATA, mark=mark),
            *(
                contrast_pictures(
                    contrasts, name=f"contrasts{end}", data="contrasts.csv", mark=mark
                )
                if 0 < len(contrasts) <= MOST_PAIRS * len({c.question for c in contrasts})
                else ()
            ),
        ),
        tables=(
            score_table(conditions, name=f"scores{end}", data=_DATA),
            interval_table(conditions, name=f"means{end}", data=_DATA),
            *(
                (
                    contrast_table(contrasts, name=f"contrasts{end}", data="contrasts.csv"),
                    model_table(
                        contrasts,
                        of(results.clmm, name),
                        name=f"model{end}",
                        data="contrasts.csv",
                    ),
                )
                if contrasts
                else ()
            ),
        ),
    )


def _all_alike(conditions: Sequence[RatedCondition]) -> str:
    given = {score for c in conditions for score, count in c.counts.items() if count}
    if len(given) != 1:
        return ""
    return (
        f"Every rating is {given.pop()}: nothing tells the conditions apart, so there is nothing "
        "to draw and nothing to test."
    )
