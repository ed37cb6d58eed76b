"""Conclusions about the first two of three rated conditions."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.one_sample_tests import equivalence, signed_rank
from analysis.stats.ratings import RatedCells, mean_difference, rated_cells
from benchmarks.validity.conclusions.conclusion import (
    EFFECT,
    Conclusion,
    Protocol,
    no_truths,
    of_mean,
)
from benchmarks.validity.studies import (
    Codes,
    Design,
    Judgements,
    judgements,
    ratings,
    true_mean_rating,
    true_rating_difference,
)

RATED: Final = ("a", "b", "c")

DIFFERENCE: Final = "difference of paired ratings, two-way clustered"
MEAN: Final = "mean rating, two-way clustered"
EQUIVALENT: Final = "two one-sided tests of paired ratings, two-way clustered"
NAIVE: Final = "pooled Wilcoxon of ratings"


def conclude_ratings(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions if participants and items differ in taste."""
    return _of_ratings(judgements(design, len(RATED), generator), design, generator)


def conclude_agreed_ratings(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return the same if participants and items differ only in level."""
    judged = judgements(design, len(RATED), generator, differ=False)
    return _of_ratings(judged, design, generator)


def conclude_equivalence(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return whether conditions are found equivalent, with a margin that `EFFECT` just reaches."""
    judged = judgements(design, len(RATED), generator)
    cells = _cells(judged, ratings(judged, design, generator))
    margin = true_rating_difference(replace(design, effect=EFFECT))
    found = equivalence(mean_difference(cells, 0, 1), margin)
    return {EQUIVALENT: Conclusion(p_value=found.p_value)}


def _of_ratings(
    judged: Judgements, design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    given = ratings(judged, design, generator)
    mean = clustered_mean(
        given[:, 0].astype(np.float64),
        judged.participants,
        judged.items,
        null=np.nan,
        limits=(1.0, 5.0),
    )
    naive = signed_rank((given[:, 0] - given[:, 1]).astype(np.float64))
    return {
        DIFFERENCE: of_mean(mean_difference(_cells(judged, given), 0, 1)),
        MEAN: of_mean(mean),
        NAIVE: Conclusion(p_value=naive.p_value),
    }


def _cells(judged: Judgements, given: Codes) -> RatedCells:
    return rated_cells(
        given.ravel(),
        np.tile(np.arange(len(RATED)), len(given)),
        np.repeat(judged.participants, len(RATED)),
        np.repeat(judged.items, len(RATED)),
        count=len(RATED),
    )


def _truths(design: Design) -> Mapping[str, float]:
    return {
        DIFFERENCE: true_rating_difference(design),
        MEAN: true_mean_rating(design),
    }


def _agreed_truths(design: Design) -> Mapping[str, float]:
    return {
        DIFFERENCE: true_rating_difference(design, tastes=False),
        MEAN: true_mean_rating(design, tastes=False),
    }


RATINGS: Final = Protocol(conclude=conclude_ratings, truths=_truths, naive=(NAIVE,))
AGREED_RATINGS: Final = Protocol(
    conclude=conclude_agreed_ratings, truths=_agreed_truths, naive=(NAIVE,)
)
RATED_EQUIVALENCE: Final = Protocol(
    conclude=conclude_equivalence, truths=no_truths, effects=(EFFECT, 0.0)
)
