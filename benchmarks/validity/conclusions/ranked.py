"""Conclusions about the first of several ranked conditions."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
import pandas as pd

from analysis.stats.rankings import Blocks, friedman, placements, rank_summaries
from analysis.stats.samples import group_means
from analysis.stats.strength_models import PlackettLuce, plackett_luce
from benchmarks.validity.conclusions.conclusion import (
    RANKS_HOLD,
    Conclusion,
    Protocol,
    of_error,
    of_mean,
    of_ranks,
    of_two_way,
)
from benchmarks.validity.studies import Codes, Design, judgements, ranks

RANKED: Final = ("a", "b", "c", "d", "e")

SETTLED: Final = 20_000
"""Rankings from which a truth without a formula is estimated."""

MEAN_RANK: Final = "mean rank, two-way clustered"
FIRST: Final = "share of first places, two-way clustered"
WORTH: Final = "Plackett-Luce worth, two-way clustered"
RANKS: Final = "Plackett-Luce ranks of all conditions"
BY_PARTICIPANT: Final = "Plackett-Luce worth, clustered by participant"
MEANS_FRIEDMAN: Final = "Friedman on participant means"
NAIVE_WORTH: Final = "Plackett-Luce worth, errors of the model"
NAIVE_FRIEDMAN: Final = "Friedman on all rankings"


def conclude_rankings(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions of one study."""
    judged = judgements(design, len(RANKED), generator)
    placed = ranks(judged, generator)
    fit = _fitted(placed, judged.participants, judged.items)
    first = rank_summaries(placements(_table(placed, judged.participants, judged.items), RANKED))[0]
    goodness = (1 + len(RANKED) - placed).astype(np.float64)
    by_person = np.column_stack([group_means(column, judged.participants) for column in goodness.T])
    return {
        MEAN_RANK: of_mean(first.mean_rank),
        FIRST: of_mean(first.first_share),
        WORTH: of_two_way(fit.strengths, fit.two_way),
        RANKS: of_ranks(fit.strengths, fit.two_way, effect=design.effect),
        BY_PARTICIPANT: of_error(fit.strengths[0], fit.errors[0]),
        MEANS_FRIEDMAN: Conclusion(
            p_value=friedman(Blocks(conditions=RANKED, means=by_person)).p_value
        ),
        NAIVE_WORTH: of_error(fit.strengths[0], fit.errors_by_model[0]),
        NAIVE_FRIEDMAN: Conclusion(
            p_value=friedman(Blocks(conditions=RANKED, means=goodness)).p_value
        ),
    }


def _truths(design: Design) -> Mapping[str, float]:
    """Return the limits of the numbers for many participants and items."""
    worth, mean_rank, first = 0.0, (len(RANKED) + 1) / 2, 1 / len(RANKED)
    if design.effect:
        generator = np.random.default_rng(0)
        # Everybody ranks once, about their own item.
        alone = replace(design, participants=SETTLED, items=1)
        alone = replace(alone, participant_sd=design.spread, item_sd=0.0)
        judged = judgements(alone, len(RANKED), generator)
        placed = ranks(judged, generator)
        worth = float(_fitted(placed, judged.participants, judged.items).strengths[0])
        mean_rank, first = float(placed[:, 0].mean()), float((placed[:, 0] == 1).mean())
    return {
        MEAN_RANK: mean_rank,
        FIRST: first,
        RANKS: RANKS_HOLD,
        **dict.fromkeys((WORTH, BY_PARTICIPANT, NAIVE_WORTH), worth),
    }


def _fitted(placed: Codes, participants: Codes, items: Codes) -> PlackettLuce:
    return plackett_luce(_table(placed, participants, items), RANKED)


def _table(placed: Codes, participants: Codes, items: Codes) -> pd.DataFrame:
    """Return rankings, shape (N, conditions), as a table with one row for each place."""
    count, width = placed.shape
    return pd.DataFrame(
        {
            "ranking": np.repeat(np.arange(count), width),
            "participant": np.repeat(participants, width),
            "segment": np.repeat(items, width),
            "condition": np.tile(RANKED, count),
            "rank": placed.ravel(),
        }
    )


RANKINGS: Final = Protocol(
    conclude=conclude_rankings, truths=_truths, naive=(NAIVE_WORTH, NAIVE_FRIEDMAN)
)
