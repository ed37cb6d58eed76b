"""Strengths and worths of conditions, their differences, and the ranks that they allow."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Final, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.results.grouping import PairPlace, codes, shown_conditions
from analysis.stats.bradley_terry import Votes, bradley_terry
from analysis.stats.clustered_mean import LEVEL, Estimate, Interval
from analysis.stats.f_tests import FTest
from analysis.stats.plackett_luce import plackett_luce
from analysis.stats.samples import group_means
from analysis.stats.signed_rank import sign_test
from analysis.stats.strength_differences import difference_tests, omnibus, rank_intervals
from analysis.stats.strengths import Strengths as Fitted

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

ONE_SEGMENT: Final = "one segment: intervals and ranks take it as the only one of interest"

PENALISED: Final = (
    "strengths are finite only because each condition is given half a win and half a loss against "
    "an average one (pseudo-rankings of Turner and others 2020)"
)

SWEPT: Final = (
    "one of the two never lost to the other: the difference has no interval, and an exact sign "
    "test of participants decides, who alone are taken as a sample"
)

NEVER_MET: Final = (
    "one of the two conditions never lost, and they were never compared with each other"
)

LEANS_ON_ONE: Final = "one participant or one segment alone bears this difference"


@dataclass(frozen=True, kw_only=True)
class Standing(Interval):
    """How strong one condition is beside the others, in logits that add up to zero.

    Attributes
    ----------
    condition : str
        Which one.
    standard_error, by_participant : float
        Clustered by participant and segment, and by participant alone; NaN where a condition is
        unbeaten.
    best, worst : int or None
        The ranks that it may have, from 1, at 95% for all conditions together; None where nothing
        is known.
    """

    condition: str
    standard_error: float
    by_participant: float
    best: int | None
    worst: int | None


@dataclass(frozen=True, kw_only=True)
class Standings:
    """How strong conditions are, one beside the others.

    Attributes
    ----------
    conditions : tuple of Standing
        In the order of the table.
    omnibus : FTest
        Whether conditions differ at all.
    log_likelihood : float
        At the estimates.
    n, participants, segments : int
        What it rests on.
    method : str
        Which errors the intervals and ranks rest on.
    remark, reason : str
        What limits the result; why there is none.
    """

    conditions: tuple[Standing, ...]
    omnibus: FTest
    log_likelihood: float
    n: int
    participants: int
    segments: int
    method: str
    remark: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Strengths(Standings):
    """Log strengths of Bradley and Terry's model with Davidson's ties and a left-side term.

    Attributes
    ----------
    tie, tie_error : float
        Davidson's log nu: how likely ties are among equals; NaN where nobody tied.
    left, left_error : float
        The left side's advantage in logits.
    """

    tie: float
    tie_error: float
    left: float
    left_error: float


@dataclass(frozen=True, kw_only=True)
class Worths(Standings):
    """Log worths of Plackett and Luce's model, partial and tied rankings included.

    Attributes
    ----------
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    """

    ties: Mapping[int, float]


@dataclass(frozen=True, kw_only=True)
class StrengthContrast(Estimate, PairPlace):
    """How much stronger a is than b, in logits.

    Attributes
    ----------
    p_holm : float
        `p_value`, corrected over the report's family; NaN outside of it.
    by : {'wald', 'sign'}
        The difference by its error, or the sign test of participants where one never lost.
    """

    p_holm: float = math.nan
    by: Literal["wald", "sign"] = "wald"


def strengths_of(
    answers: pd.DataFrame, of: str | None, question: str
) -> tuple[Strengths, tuple[StrengthContrast, ...]]:
    """Fit strengths to pairwise answers to one question, and compare every two conditions."""
    left, right = codes(answers, "left"), codes(answers, "right")
    shown, number = np.unique(np.concatenate([left, right]), return_inverse=True)
    names = tuple(str(answers["left"].cat.categories[place]) for place in shown)
    votes = Votes(
        conditions=names,
        left=number[: len(left)].astype(np.intp),
        right=number[len(left) :].astype(np.intp),
        outcome=np.sign(3 - answers["value"].to_numpy()).astype(np.intp),
        participant=_numbered(answers, "participant"),
        segment=_numbered(answers, "segment"),
    )
    found = bradley_terry(votes)
    if not votes.outcome.any():
        found = replace(found, reason="all answers are ties")
    known = not found.reason
    p_values = _p_values(found, votes)
    return Strengths(
        tie=found.tie if known and found.tie is not None else math.nan,
        tie_error=found.tie_error if known else math.nan,
        left=found.left if known and found.left is not None else math.nan,
        left_error=found.left_error if known else math.nan,
        **_standings(
            found,
            p_values,
            _segments(answers),
            "nobody answered with a tie" if known and found.tie is None else "",
        ),
    ), _contrasts(found, p_values, of, question, _segments(answers))


def worths_of(
    answers: pd.DataFrame, of: str | None, question: str
) -> tuple[Worths, tuple[StrengthContrast, ...]]:
    """Fit worths to the rankings of one question, and compare every two conditions."""
    names = shown_conditions(answers)
    rows = pd.DataFrame(
        {
            "ranking": answers.groupby(RANKING, observed=True, dropna=False).ngroup(),
            "condition": answers["condition"].to_numpy(object),
            "rank": answers["value"].to_numpy(),
            "participant": codes(answers, "participant"),
            "segment": codes(answers, "segment"),
        }
    )
    found = plackett_luce(rows, conditions=names)
    if (rows.groupby("ranking")["rank"].nunique() < 2).all():
        found = replace(found, reason="every ranking ties all that it places")
    known = not found.reason
    p_values = _p_values(found, _votes_of_rankings(rows, names))
    return Worths(
        ties=found.ties if known else {},
        **_standings(found, p_values, _segments(answers)),
    ), _contrasts(found, p_values, of, question, _segments(answers))


RANKING: Final = ["participant", "segment", "trial"]
"""What tells one ranking from another."""


def _p_values(found: Fitted, votes: Votes) -> Floats:
    """Return the p of every two conditions; of different tiers, of the sign test."""
    count = len(found.strengths)
    if found.two_way is None or found.reason:
        return np.full((count, count), math.nan)
    p_values = difference_tests(found.strengths, found.two_way)
    for a, b in combinations(range(count), 2):
        if found.tiers[a] != found.tiers[b]:
            p_values[a, b] = p_values[b, a] = _sign_p(votes, a, b)
    return p_values


def _sign_p(votes: Votes, a: int, b: int) -> float:
    """Return the sign test's p of participants preferring a to b; NaN without any."""
    for_a = np.where(votes.left == a, votes.outcome, -votes.outcome).astype(np.float64)
    own = ((votes.left == a) & (votes.right == b)) | ((votes.left == b) & (votes.right == a))
    return sign_test(group_means(for_a[own], votes.participant[own])).p_value


def _votes_of_rankings(rows: pd.DataFrame, names: tuple[str, ...]) -> Votes:
    """Return a vote for each two conditions of every ranking, the better placed one the winner."""
    table = rows.pivot(index="ranking", columns="condition", values="rank")[list(names)]
    of_ranking = rows.groupby("ranking")[["participant", "segment"]].first().loc[table.index]
    ranks = table.to_numpy(np.float64)
    first, second = np.triu_indices(len(names), 1)
    ranking, pair = np.nonzero(~np.isnan(ranks[:, first] + ranks[:, second]))
    left, right = first[pair], second[pair]
    return Votes(
        conditions=names,
        left=left,
        right=right,
        outcome=np.sign(ranks[ranking, right] - ranks[ranking, left]).astype(np.intp),
        participant=of_ranking["participant"].to_numpy()[ranking],
        segment=of_ranking["segment"].to_numpy()[ranking],
    )


def _standings(found: Fitted, p_values: Floats, segments: int, *remarks: str) -> dict[str, Any]:
    """Return what Bradley-Terry and Plackett-Luce have in common: the fields of `Standings`."""
    unknown = np.full(len(found.conditions), math.nan)
    reach, method = unknown, ""
    ranks: tuple[tuple[int | None, int | None], ...] = ((None, None),) * len(unknown)
    if found.two_way is not None and not found.reason:
        law = stats.t(found.two_way.freedoms)
        reach = law.ppf((1 + LEVEL) / 2) * found.two_way.errors
        ranks = rank_intervals(found.strengths, p_values)
        freedom = f"t with at least {found.two_way.freedom:.3g} degrees of freedom"
        method = f"{found.two_way.method}; {freedom}"
    bounded = not found.reason and not found.swept
    swept = found.swept and f"{found.swept}; {PENALISED}"
    columns = np.stack([found.strengths, reach, found.errors_two_way, found.errors], axis=1)
    if found.reason:
        columns[:, 0] = math.nan
    if not bounded:
        columns[:, 1:] = math.nan
    said = (found.remark, *remarks, swept, ONE_SEGMENT if segments == 1 else "")
    return {
        "conditions": tuple(
            Standing(
                condition=name,
                estimate=estimate,
                low=estimate - far,
                high=estimate + far,
                standard_error=error,
                by_participant=one_way,
                best=best,
                worst=worst,
                reason=found.reason or found.swept or found.remark,
            )
            for name, (estimate, far, error, one_way), (best, worst) in zip(
                found.conditions, columns.tolist(), ranks, strict=True
            )
        ),
        "omnibus": _omnibus(found),
        "log_likelihood": math.nan if found.reason else found.log_likelihood,
        "n": found.n,
        "participants": found.participants,
        "segments": segments,
        "method": method,
        "remark": "; ".join(filter(None, said)),
        "reason": found.reason,
    }


def _omnibus(found: Fitted) -> FTest:
    if found.reason or found.two_way is None:
        return FTest(reason=found.reason or found.remark)
    if found.swept:
        return FTest(reason=found.swept)
    return omnibus(found.strengths, found.two_way)


def _contrasts(
    found: Fitted, p_values: Floats, of: str | None, question: str, segments: int
) -> tuple[StrengthContrast, ...]:
    strengths = found.strengths
    return tuple(
        StrengthContrast(
            set=of,
            a=found.conditions[a],
            b=found.conditions[b],
            question=question,
            estimate=math.nan if found.reason else float(strengths[a] - strengths[b]),
            n=found.n,
            participants=found.participants,
            segments=segments,
            **_tested(float(strengths[a] - strengths[b]), found, float(p_values[a, b]), (a, b)),
        )
        for a, b in combinations(range(len(strengths)), 2)
    )


def _tested(difference: float, found: Fitted, p: float, pair: tuple[int, int]) -> dict[str, Any]:
    """Return the interval and the test of a difference, or why there is none."""
    if found.reason or found.two_way is None:
        return {"reason": found.reason or found.remark}
    if found.tiers[pair[0]] != found.tiers[pair[1]]:
        reason = NEVER_MET if math.isnan(p) else ""
        return {"p_value": p, "by": "sign", "remark": SWEPT, "reason": reason}
    error, freedom = found.two_way.differences[pair], found.two_way.difference_freedoms[pair]
    if math.isnan(error):
        return {"reason": LEANS_ON_ONE}
    reach = float(stats.t(freedom).ppf((1 + LEVEL) / 2) * error)
    return {
        "low": difference - reach,
        "high": difference + reach,
        "standard_error": float(error),
        "df": float(freedom),
        "p_value": p,
        "method": found.two_way.method,
    }


def _segments(answers: pd.DataFrame) -> int:
    return len(np.unique(codes(answers, "segment")))


def _numbered(answers: pd.DataFrame, column: str) -> Codes:
    """Return a column of names as numbers from 0 without gaps."""
    return np.unique(codes(answers, column), return_inverse=True)[1].astype(np.intp)
