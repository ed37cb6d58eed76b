"""Bradley-Terry strengths from pairwise preferences, with ties and a left-side effect."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from analysis.stats.strengths.choices import ChoiceFit, Choices, Situation, fit_choices
from analysis.stats.strengths.identified import Links, links
from analysis.stats.strengths.two_way import ONE_PARTICIPANT, TwoWayErrors, deviations
from analysis.stats.strengths.votes import Votes

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
Ties = Literal["davidson", "half"]


@dataclass(frozen=True, kw_only=True)
class BradleyTerry:
    """Strengths on the log scale; they add up to zero.

    Attributes
    ----------
    conditions : tuple of str
        In the order of everything else.
    strengths : ndarray, shape (conditions,)
        Log strengths; NaN where they are not identified.
    covariance : ndarray, shape (conditions, conditions)
        Of the strengths, clustered by participant (CR0).
    errors, errors_by_model, errors_robust : ndarray, shape (conditions,)
        Standard errors: clustered by participant; of the model; robust but not clustered.
    two_way : TwoWayErrors or None
        Errors clustered by participant and segment; None where segments are not known, or there
        is one of either.
    tie : float or None
        Davidson's log nu: how likely ties are among equals; None where ties are halved.
    tie_error : float
        Its clustered standard error; NaN where there is none.
    left : float or None
        The left side's advantage in logits; None where it was not asked for.
    left_error : float
        Its clustered standard error; NaN where there is none.
    log_likelihood : float
        At the estimates.
    answers, participants : int
        What it rests on.
    tiers : ndarray of int, shape (conditions,)
        See `Links`; of one tier unless `swept` says who never lost, where the fit is penalised.
    swept : str
        Which conditions never lost to which; empty where every one did.
    reason : str
        Why there are no strengths; empty where there are. `remark` says why they have no errors.
    """

    conditions: tuple[str, ...]
    strengths: Floats
    covariance: Floats
    errors: Floats
    errors_by_model: Floats
    errors_robust: Floats
    two_way: TwoWayErrors | None
    tie: float | None
    tie_error: float
    left: float | None
    left_error: float
    log_likelihood: float
    answers: int
    participants: int
    tiers: Codes
    swept: str
    reason: str = ""

    @property
    def remark(self) -> str:
        """Why clustered errors are NaN although there are strengths; empty where they are not."""
        return ONE_PARTICIPANT if self.participants < 2 and not self.reason else ""

    @property
    def errors_two_way(self) -> Floats:
        """Standard errors clustered by participant and segment; NaN where there are none."""
        none = np.full(len(self.conditions), math.nan)
        return none if self.two_way is None else self.two_way.errors


def bradley_terry(votes: Votes, *, ties: Ties = "davidson", left: bool = True) -> BradleyTerry:
    """Fit Bradley-Terry strengths.

    With strengths p and a left advantage g, the left one is preferred, tied with, or worse than
    the right one in the proportion g p_left : nu sqrt(g p_left p_right) : p_right (Davidson 1970;
    the left-side term as in Davidson & Beaver 1977).

    Parameters
    ----------
    votes : Votes
        Who preferred what to what.
    ties : {'davidson', 'half'}
        Model ties, or give half a vote to each side and model wins alone.
    left : bool
        Whether the left side may have an advantage.
    """
    count, modelled = len(votes.conditions), ties == "davidson"
    linked = links(votes.beats, votes.conditions)
    if reason := linked.apart if len(votes.left) else "no answers":
        return unknown(votes, reason)
    # Without any tie their frequency has no estimate; the model without it is the same.
    modelled = modelled and bool(votes.table[..., 1].any())
    shown = votes.table.sum(axis=2).ravel() > 0
    pairs, place = np.flatnonzero(shown), np.cumsum(shown) - 1
    situations = tuple(
        _situation(int(pair) // count, int(pair) % count, count, modelled, left) for pair in pairs
    )
    people, kinds, times = votes.tallies
    fit = fit_choices(
        Choices(
            situations=situations,
            situation=place[kinds // 3],
            way=kinds % 3,
            cluster=people,
            times=times,
        ),
        _prior(count, modelled, left) if linked.swept else None,
    )
    if votes.segment is None:
        return centred(votes, fit, None, linked, modelled, left)
    kind = 3 * place[votes.left * count + votes.right] + 1 - votes.outcome
    return centred(votes, fit, kind, linked, modelled, left)


def _prior(count: int, modelled: bool, left: bool) -> Floats:
    """Return one comparison of each condition with the average, and one of the sides."""
    rows = np.zeros((count + left, count - 1 + modelled + left))
    rows[:count, : count - 1] = np.eye(count)[:, 1:] - 1 / count
    if left:
        rows[-1, -1] = 1.0
    return rows


def _situation(first: int, second: int, count: int, modelled: bool, left: bool) -> Situation:
    """Return left win, tie and right win; the first condition's log strength is zero."""
    strength = np.eye(count)[:, 1:]
    extra = int(modelled) + int(left)
    wins = np.zeros((2, count - 1 + extra))
    wins[0, : count - 1], wins[1, : count - 1] = strength[first], strength[second]
    if left:
        wins[0, -1] = 1.0
    if not modelled:
        return Situation(features=wins, ways=np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]))
    tie = wins.mean(axis=0)
    tie[count - 1] += 1.0
    return Situation(features=np.stack([wins[0], tie, wins[1]]), ways=np.eye(3))


def centred(
    votes: Votes, fit: ChoiceFit, kind: Codes | None, linked: Links, modelled: bool, left: bool
) -> BradleyTerry:
    """Return strengths that add up to zero from those relative to the first condition.

    Parameters
    ----------
    fit : ChoiceFit
        Of the other conditions' log strengths, then the tie where `modelled`, then the left
        side's advantage where `left`.
    kind : ndarray of int, shape (N,), or None
        Each answer's row among `fit.influences`; needed where segments are known.
    """
    count = len(votes.conditions)
    turn = np.eye(count)[:, 1:] - 1 / count
    strengths, covariances = (
        turn @ fit.estimates[: count - 1],
        [
            turn @ part[: count - 1, : count - 1] @ turn.T
            for part in (fit.clustered, fit.by_model, fit.robust)
        ],
    )
    errors = deviations(fit.clustered)
    influences = fit.influences[:, : count - 1] @ turn.T
    return BradleyTerry(
        conditions=votes.conditions,
        strengths=strengths,
        covariance=covariances[0],
        errors=deviations(covariances[0]),
        errors_by_model=deviations(covariances[1]),
        errors_robust=deviations(covariances[2]),
        two_way=None
        if votes.segment is None or kind is None
        else TwoWayErrors.of(influences, fit.situation, kind, votes.participant, votes.segment),
        tie=float(fit.estimates[count - 1]) if modelled else None,
        tie_error=float(errors[count - 1]) if modelled else math.nan,
        left=float(fit.estimates[-1]) if left else None,
        left_error=float(errors[-1]) if left else math.nan,
        log_likelihood=fit.log_likelihood,
        answers=fit.choices,
        participants=votes.participants,
        tiers=linked.tiers,
        swept=linked.swept,
        reason="" if fit.converged else "the strengths did not converge",
    )


def unknown(votes: Votes, reason: str) -> BradleyTerry:
    """Return a result without strengths, which says why there are none."""
    count = len(votes.conditions)
    none = np.full(count, math.nan)
    return BradleyTerry(
        conditions=votes.conditions,
        strengths=none,
        covariance=np.full((count, count), math.nan),
        errors=none,
        errors_by_model=none,
        errors_robust=none,
        two_way=None,
        tie=None,
        tie_error=math.nan,
        left=None,
        left_error=math.nan,
        log_likelihood=math.nan,
        answers=len(votes.left),
        participants=votes.participants,
        tiers=np.zeros(count, np.intp),
        swept="",
        reason=reason,
    )
