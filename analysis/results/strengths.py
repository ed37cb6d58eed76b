"""Strengths and worths of conditions, their differences, and the ranks that they allow."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Final, Literal

import numpy as np
import pandas as pd

from analysis.results.grouping import PairKey, codes, shown_conditions
from analysis.stats.clustered_mean import Estimate, Interval, t_quantile
from analysis.stats.f_tests import FTest
from analysis.stats.one_sample_tests import sign_test
from analysis.stats.samples import group_means
from analysis.stats.strength_differences import difference_tests, omnibus, rank_intervals
from analysis.stats.strength_models import Votes, bradley_terry, plackett_luce
from analysis.stats.strengths import FittedStrengths
from motion.arrays import Floats, Indices

ONE_SEGMENT: Final = "one segment: intervals and ranks hold for this segment alone"

PENALISED: Final = (
    "strengths are finite only because each condition is given half a win and half a loss against "
    "an average one (pseudo-rankings of Turner and others 2020)"
)

NEVER_LOST: Final = (
    "one of the two never lost to the other: the difference has no interval, and is decided by an "
    "exact sign test, which treats participants as a sample and segments as fixed"
)

NEVER_MET: Final = (
    "one of the two conditions never lost, and they were never compared with each other"
)

LEANS_ON_ONE: Final = "this difference rests on a single participant or a single segment"


@dataclass(frozen=True, kw_only=True)
class ConditionStrength(Interval):
    """The log strength of one condition, in logits; the strengths of all conditions sum to zero.

    Attributes
    ----------
    condition : str
        The condition's name.
    standard_error, by_participant : float
        Standard errors clustered by participant and segment, and by participant alone; NaN if a
        condition never lost.
    best, worst : int or None
        Ends of the rank interval, from 1, at 95% for all conditions together; None if there are no
        errors.
    """

    condition: str
    standard_error: float
    by_participant: float
    best: int | None
    worst: int | None


@dataclass(frozen=True, kw_only=True)
class StrengthModel:
    """The strengths of all conditions.

    Attributes
    ----------
    conditions : tuple of ConditionStrength
        In the order of the table.
    omnibus : FTest
        Whether conditions differ at all.
    log_likelihood : float
        At the estimates.
    n, participants, segments : int
        Numbers of answers (or rankings), participants and segments.
    method : str
        The errors behind the intervals and ranks.
    remark, reason : str
        A caution about the result; why there is none.
    """

    conditions: tuple[ConditionStrength, ...]
    omnibus: FTest
    log_likelihood: float
    n: int
    participants: int
    segments: int
    method: str
    remark: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class BradleyTerryStrengths(StrengthModel):
    """Log strengths of Bradley and Terry's model with Davidson's ties and a left-side term.

    Attributes
    ----------
    tie, tie_error : float
        Davidson's log nu: how likely ties are between equals; NaN if there are no ties.
    left, left_error : float
        The left side's advantage in logits.
    """

    tie: float
    tie_error: float
    left: float
    left_error: float


@dataclass(frozen=True, kw_only=True)
class PlackettLuceWorths(StrengthModel):
    """Log worths of Plackett and Luce's model, partial and tied rankings included.

    Attributes
    ----------
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    """

    ties: Mapping[int, float]


@dataclass(frozen=True, kw_only=True)
class StrengthDifference(Estimate, PairKey):
    """How much stronger a is than b, in logits.

    Attributes
    ----------
    p_holm : float
        `p_value`, corrected over the report's family; NaN outside of it.
    by : {'wald', 'sign'}
        The difference by its error, or the sign test of participants if one never lost.
    """

    p_holm: float = math.nan
    by: Literal["wald", "sign"] = "wald"


def fit_strengths(
    answers: pd.DataFrame, set_name: str | None, question: str
) -> tuple[BradleyTerryStrengths, tuple[StrengthDifference, ...]]:
    """Fit strengths to pairwise answers to one question, and compare all pairs of conditions."""
    left, right = codes(answers, "left"), codes(answers, "right")
    shown, number = np.unique(np.concatenate([left, right]), return_inverse=True)
    votes = Votes(
        conditions=tuple(str(name) for name in answers["left"].cat.categories[shown]),
        left=number[: len(left)],
        right=number[len(left) :],
        outcome=np.sign(3 - answers["value"].to_numpy()).astype(np.intp),
        participant=codes(answers, "participant"),
        segment=codes(answers, "segment"),
    )
    fit = bradley_terry(votes)
    no_ties = "nobody answered with a tie" if not fit.reason and math.isnan(fit.tie) else ""

    def preferences(a: int, b: int) -> tuple[Floats, Indices]:
        towards = np.where(votes.left == a, votes.outcome, -votes.outcome).astype(np.float64)
        both = np.isin(votes.left, (a, b)) & np.isin(votes.right, (a, b))
        return towards[both], votes.participant[both]

    segments = len(np.unique(votes.segment))
    fields, differences = _results(fit, preferences, set_name, question, segments, no_ties)
    return BradleyTerryStrengths(
        tie=fit.tie, tie_error=fit.tie_error, left=fit.left, left_error=fit.left_error, **fields
    ), differences


def fit_worths(
    answers: pd.DataFrame, set_name: str | None, question: str
) -> tuple[PlackettLuceWorths, tuple[StrengthDifference, ...]]:
    """Fit worths to the rankings of one question, and compare all pairs of conditions."""
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
    fit = plackett_luce(rows, names)

    def preferences(a: int, b: int) -> tuple[Floats, Indices]:
        ranks = rows.pivot(index="ranking", columns="condition", values="rank")
        ahead = (ranks[names[b]] - ranks[names[a]]).dropna()
        participants = rows.groupby("ranking")["participant"].first()[ahead.index]
        return np.sign(ahead.to_numpy(np.float64)), participants.to_numpy()

    segments = rows["segment"].nunique()
    fields, differences = _results(fit, preferences, set_name, question, segments)
    return PlackettLuceWorths(ties=fit.ties, **fields), differences


RANKING: Final = ["participant", "segment", "trial"]
"""Columns that identify a ranking."""

_Preferences = Callable[[int, int], tuple[Floats, Indices]]
"""Returns each preference for one condition over another, from -1 to 1, and its participant."""


def _results(
    fit: FittedStrengths,
    preferences: _Preferences,
    set_name: str | None,
    question: str,
    segments: int,
    remark: str = "",
) -> tuple[dict[str, Any], tuple[StrengthDifference, ...]]:
    """Return the fields of `StrengthModel`, and the difference of each pair of conditions."""
    p_values = _p_values(fit, preferences)
    fields = {
        "conditions": _condition_strengths(fit, p_values),
        "omnibus": _omnibus(fit),
        "log_likelihood": fit.log_likelihood,
        "n": fit.n,
        "participants": fit.participants,
        "segments": segments,
        "method": ""
        if fit.two_way is None
        else f"{fit.two_way.method}; t with at least {fit.two_way.freedom:.3g} degrees of freedom",
        "remark": "; ".join(
            filter(
                None,
                (
                    fit.remark,
                    remark,
                    fit.unbeaten and f"{fit.unbeaten}; {PENALISED}",
                    ONE_SEGMENT * (segments == 1),
                ),
            )
        ),
        "reason": fit.reason,
    }
    return fields, tuple(
        StrengthDifference(
            set=set_name,
            a=fit.conditions[a],
            b=fit.conditions[b],
            question=question,
            estimate=float(fit.strengths[a] - fit.strengths[b]),
            n=fit.n,
            participants=fit.participants,
            segments=segments,
            **_tested(fit, a, b, float(p_values[a, b])),
        )
        for a, b in combinations(range(len(fit.strengths)), 2)
    )


def _p_values(fit: FittedStrengths, preferences: _Preferences) -> Floats:
    """Return p for each pair of conditions; from the sign test if one never lost to the other."""
    if fit.two_way is None:
        return np.full((len(fit.strengths),) * 2, math.nan)
    p_values = difference_tests(fit.strengths, fit.two_way)
    for a, b in combinations(range(len(fit.strengths)), 2):
        if fit.tiers[a] != fit.tiers[b]:
            p_values[a, b] = p_values[b, a] = sign_test(group_means(*preferences(a, b))).p_value
    return p_values


def _condition_strengths(fit: FittedStrengths, p_values: Floats) -> tuple[ConditionStrength, ...]:
    columns = np.full((len(fit.strengths), 3), math.nan)
    ranks: tuple[tuple[int | None, int | None], ...] = ((None, None),) * len(columns)
    if fit.two_way is not None:
        ranks = rank_intervals(fit.strengths, p_values)
        if not fit.unbeaten:
            margins = t_quantile(fit.two_way.freedoms) * fit.two_way.errors
            columns = np.stack([margins, fit.two_way.errors, fit.errors], axis=1)
    return tuple(
        ConditionStrength(
            condition=name,
            estimate=estimate,
            low=estimate - margin,
            high=estimate + margin,
            standard_error=error,
            by_participant=by_participant,
            best=best,
            worst=worst,
            reason=fit.reason or fit.unbeaten or fit.remark,
        )
        for name, estimate, (margin, error, by_participant), (best, worst) in zip(
            fit.conditions, fit.strengths.tolist(), columns.tolist(), ranks, strict=True
        )
    )


def _omnibus(fit: FittedStrengths) -> FTest:
    if fit.two_way is None or fit.unbeaten:
        return FTest(reason=fit.reason or fit.remark or fit.unbeaten)
    return omnibus(fit.strengths, fit.two_way)


def _tested(fit: FittedStrengths, a: int, b: int, p_value: float) -> dict[str, Any]:
    """Return the interval and the test of a difference, or why there is none."""
    if fit.two_way is None:
        return {"reason": fit.reason or fit.remark}
    if fit.tiers[a] != fit.tiers[b]:
        reason = NEVER_MET if math.isnan(p_value) else ""
        return {"p_value": p_value, "by": "sign", "remark": NEVER_LOST, "reason": reason}
    error, freedom = fit.two_way.differences[a, b], fit.two_way.difference_freedoms[a, b]
    if math.isnan(error):
        return {"reason": LEANS_ON_ONE}
    difference = float(fit.strengths[a] - fit.strengths[b])
    margin = float(t_quantile(freedom) * error)
    return {
        "low": difference - margin,
        "high": difference + margin,
        "standard_error": float(error),
        "df": float(freedom),
        "p_value": p_value,
        "method": fit.two_way.method,
    }
