"""Ratings in tables: as S2UE's Table 2, how many reach each score, and every contrast."""

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
    Table,
    count_cell,
    counted,
    interval_cell,
    number_cell,
    p_cell,
    share_cell,
    table_by_question,
    table_of,
)
from analysis.report.wording import (
    CLUSTERED,
    HOLM,
    INTERVAL,
    gathered,
    notes,
    number,
    place_of,
)
from analysis.results.rating import RatedCondition
from analysis.results.rating_contrasts import RatingContrast, RatingModel
from analysis.stats.clustered_mean import LEVEL

DATA: Final = "conditions.csv"
"""File in the report's ``tables`` folder with all that is known of conditions."""


def score_table(conditions: Sequence[RatedCondition]) -> Table:
    """Return means and standard deviations, the best mean bold and the second best underlined."""
    marks = _marks(conditions)
    return table_by_question(
        {
            (wording.condition(c.condition), c.question): (
                counted(c.estimate, number(c.estimate), **marks.get((c.condition, c.question), {})),
                number_cell(c.sd),
                count_cell(c.n),
            )
            for c in conditions
        },
        "condition",
        ("mean", "SD", "n"),
        caption="Mean and standard deviation of all ratings after "
        "exclusions, in the layout of S2UE's Table 2; n: ratings. Higher is better; the best mean "
        "is bold and the second best underlined, which is not a test.",
        name="scores",
        data=DATA,
    )


def interval_table(conditions: Sequence[RatedCondition]) -> Table:
    """Return means with their intervals, and how many percent reach each score."""
    scores = tuple(conditions[0].at_least)[1:]
    return table_of(
        conditions,
        *CONDITION,
        ("n", lambda c: count_cell(c.n)),
        ("mean", lambda c: number_cell(c.estimate)),
        (INTERVAL, lambda c: interval_cell(c.low, c.high)),
        *((f"≥ {score}", partial(_reaching, score)) for score in scores),
        caption=f"Mean ratings with {LEVEL:.0%} intervals, clustered by "
        f"participant and segment ({CLUSTERED}), "
        "and how many of the n ratings are a score or a higher one, in %. After exclusions.",
        notes=gathered((place_of(c), c.reason and f"no interval: {c.reason}") for c in conditions),
        name="means",
        data=DATA,
    )


def _reaching(score: int, rated: RatedCondition) -> Cell:
    return counted(rated.at_least[score], wording.fixed(rated.at_least[score], 1))


def contrast_table(contrasts: Sequence[RatingContrast]) -> Table:
    """Return the headline test: how much better each condition is rated than each other one."""
    return table_of(
        contrasts,
        *PAIR,
        ("n", lambda c: count_cell(c.difference.n)),
        ("difference", lambda c: number_cell(c.difference.estimate)),
        (INTERVAL, lambda c: interval_cell(c.difference.low, c.difference.high)),
        ("p", lambda c: p_cell(c.difference.p_value)),
        (HOLM, lambda c: p_cell(c.difference.p_holm)),
        ("Cliff's δ", lambda c: share_cell(c.cliffs_delta.estimate)),
        (INTERVAL, lambda c: interval_cell(c.cliffs_delta.low, c.cliffs_delta.high, wording.share)),
        caption=f"How much better the first condition is rated than the "
        f"second, in scores: mean difference of paired ratings with its {LEVEL:.0%} interval, "
        f"clustered by participant and segment ({CLUSTERED}); n: "
        "pairs of ratings. p is corrected by Holm over the report's family of tests. "
        "Cliff's δ: how often the first is rated higher minus how often lower. "
        "After exclusions.",
        notes=gathered(
            (place_of(c), note)
            for c in contrasts
            for note in (
                c.difference.reason and f"no interval: {c.difference.reason}",
                c.cliffs_delta.reason and f"Cliff's δ without an interval: {c.cliffs_delta.reason}",
            )
        ),
        name="contrasts",
        data="contrasts.csv",
    )


def model_table(
    contrasts: Sequence[RatingContrast],
    models: Mapping[str, RatingModel],
) -> Table:
    """Return the same contrasts in the mixed model, beside the headline."""
    return table_of(
        contrasts,
        *PAIR,
        ("log-odds", lambda c: number_cell(c.log_odds)),
        ("odds ratio", lambda c: number_cell(c.odds_ratio)),
        caption="Beside the headline: the same contrasts in a "
        "cumulative link mixed model with crossed random intercepts of participants and segments. "
        "Log-odds and odds ratio: of a better rating for the first condition. The model takes "
        "conditions to differ alike for all participants and segments; where they do not, its "
        "errors are too small, so that it describes and does not test.",
        notes=(
            note
            for question, model in models.items()
            for note in notes(model.reason, model.remark, wording.heading(question))
        ),
        name="model",
        data="contrasts.csv",
        secondary="The same contrasts in a model",
    )


def _marks(conditions: Sequence[RatedCondition]) -> dict[tuple[str, str], dict[str, bool]]:
    """Return which means are the best and the second best of their question, as they are shown."""
    found: dict[tuple[str, str], dict[str, bool]] = {}
    for question in dict.fromkeys(c.question for c in conditions):
        asked = [c for c in conditions if c.question == question and not math.isnan(c.estimate)]
        shown = sorted({round(c.estimate, 2) for c in asked}, reverse=True)
        if len(shown) < 2:
            continue
        for c in asked:
            if round(c.estimate, 2) == shown[0]:
                found[c.condition, question] = {"best": True}
            elif round(c.estimate, 2) == shown[1]:
                found[c.condition, question] = {"second": True}
    return found
