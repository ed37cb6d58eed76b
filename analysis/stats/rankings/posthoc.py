"""Which conditions differ, after Friedman's test: Nemenyi, Conover and Wilcoxon, pair by pair."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy import stats

from analysis.stats.holm import holm
from analysis.stats.rankings.friedman import Blocks, friedman
from analysis.stats.wilcoxon import SignedRank, signed_rank


@dataclass(frozen=True, kw_only=True)
class PairwiseRanks:
    """How two conditions differ over participants.

    Attributes
    ----------
    a, b : str
        The conditions.
    difference : float
        Mean rank of a minus that of b, the larger rank being the better; NaN without a test.
    nemenyi_p : float
        Of the Studentised range; corrects for all pairs by itself.
    conover_p, conover_holm : float
        Of Conover & Iman's t, plain and after Holm's correction.
    wilcoxon : SignedRank
        Of the participants' differences a minus b.
    wilcoxon_holm, wilcoxon_normal_holm : float
        Its p value and its normal approximation after Holm's correction.
    n : int
        Participants.
    reason : str
        Why there is no test of ranks; empty where there is one.
    """

    a: str
    b: str
    difference: float
    nemenyi_p: float
    conover_p: float
    conover_holm: float
    wilcoxon: SignedRank
    wilcoxon_holm: float
    wilcoxon_normal_holm: float
    n: int
    reason: str = ""


def compare_pairs(blocks: Blocks) -> tuple[PairwiseRanks, ...]:
    """Compare every two conditions (Nemenyi 1963; Conover 1999; Wilcoxon 1945).

    Holm's corrections are over all pairs returned.
    """
    whole = friedman(blocks)
    found = [
        replace(_pair(blocks, a, b, known=not whole.reason), reason=whole.reason)
        for a, b in combinations(range(len(blocks.conditions)), 2)
    ]
    corrected = (
        holm([pair.conover_p for pair in found]),
        holm([pair.wilcoxon.p_value for pair in found]),
        holm([pair.wilcoxon.normal_p for pair in found]),
    )
    return tuple(
        replace(pair, conover_holm=conover, wilcoxon_holm=exact, wilcoxon_normal_holm=normal)
        for pair, conover, exact, normal in zip(found, *corrected, strict=True)
    )


def _pair(blocks: Blocks, a: int, b: int, *, known: bool) -> PairwiseRanks:
    count, width = blocks.means.shape
    found = PairwiseRanks(
        a=blocks.conditions[a],
        b=blocks.conditions[b],
        difference=math.nan,
        nemenyi_p=math.nan,
        conover_p=math.nan,
        conover_holm=math.nan,
        wilcoxon=signed_rank(blocks.means[:, a] - blocks.means[:, b]),
        wilcoxon_holm=math.nan,
        wilcoxon_normal_holm=math.nan,
        n=count,
    )
    if not known:
        return found
    means = blocks.ranks.mean(axis=0)
    difference = float(means[a] - means[b])
    ranged = abs(difference) / math.sqrt(width * (width + 1) / (12 * count))
    # What is left of the ranks' variance within participants once conditions are taken out.
    rest = float((blocks.ranks**2).sum()) - count * float((means**2).sum())
    freedom = (count - 1) * (width - 1)
    error = math.sqrt(2 * max(rest, 0.0) / (count * freedom))
    if error > 1e-9:
        conover = float(2 * stats.t.sf(abs(difference) / error, freedom))
    else:
        conover = 1.0 if difference == 0 else 0.0
    return replace(
        found,
        difference=difference,
        nemenyi_p=float(np.clip(stats.studentized_range.sf(ranged, width, np.inf), 0, 1)),
        conover_p=conover,
    )
