"""How the ratings of each condition are spread: Table 2 and Figures 6 and 7 of S2UE.

'At least' is their lower-bound plot: how many percent of the ratings are a score or better.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.stats.clustered_mean import Estimate, clustered_mean
from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class RatingSummary(Estimate):
    """The ratings of one condition: the estimate is their mean, tested against nothing.

    Attributes
    ----------
    condition : str
        Its name.
    sd : float
        Standard deviation of the single ratings; NaN for fewer than two.
    counts : mapping of int to int
        How often each score was given.
    at_least : mapping of int to float
        Ratings of this score or a higher one, in percent; NaN without any.
    """

    condition: str
    sd: float
    counts: Mapping[int, int]
    at_least: Mapping[int, float]


def rating_table(
    answers: pd.DataFrame,
    conditions: Sequence[str],
    scores: Sequence[int],
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> tuple[RatingSummary, ...]:
    """Summarise the ratings of one question.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `segment`, `condition` and `value`, one row per rating.
    conditions : sequence of str
        In the order wanted; one without ratings gets a row that says so.
    scores : sequence of int
        All scores that can be given, ascending.
    limits : (float, float)
        Where intervals are cut: the ends of the scale, where it is known.

    Raises
    ------
    InputError
        If a rating is none of `scores`.
    """
    values = answers["value"].to_numpy()
    strange = ~np.isin(values, scores)
    if strange.any():
        raise InputError(
            f"a rating is {values[strange][0]:g}, which is not one of the scores "
            f"{', '.join(map(str, scores))}",
            remedy="Correct the rating, or name all scores of the scale",
        )
    return tuple(
        _summary(condition, answers[answers["condition"] == condition], scores, limits)
        for condition in conditions
    )


def _summary(
    condition: str,
    ratings: pd.DataFrame,
    scores: Sequence[int],
    limits: tuple[float, float],
) -> RatingSummary:
    values = ratings["value"].to_numpy(np.float64)
    counts = [int((values == score).sum()) for score in scores]
    above = np.cumsum(counts[::-1])[::-1]
    mean = clustered_mean(
        values,
        pd.factorize(ratings["participant"])[0],
        pd.factorize(ratings["segment"])[0],
        null=math.nan,
        limits=limits,
    )
    return RatingSummary(
        **vars(mean),
        condition=condition,
        sd=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
        counts=dict(zip(scores, counts, strict=True)),
        at_least={
            score: 100 * int(count) / len(values) if len(values) else math.nan
            for score, count in zip(scores, above, strict=True)
        },
    )
