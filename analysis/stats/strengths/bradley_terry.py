"""Bradley-Terry strengths from pairwise preferences, with ties and a left-side effect."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from analysis.stats.strengths.choices import ChoiceFit, Choices, Situation, fit_choices
from analysis.stats.strengths.fitted import Links, Strengths, centring, fitted, links, unknown
from analysis.stats.strengths.two_way import deviations
from analysis.stats.strengths.votes import Votes

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
Ties = Literal["davidson", "half"]


@dataclass(frozen=True, kw_only=True)
class BradleyTerry(Strengths):
    """Strengths of conditions that were compared in pairs.

    Attributes
    ----------
    tie : float or None
        Davidson's log nu: how likely ties are among equals; None where ties are halved.
    tie_error : float
        Its clustered standard error; NaN where there is none.
    left : float or None
        The left side's advantage in logits; None where it was not asked for.
    left_error : float
        Its clustered standard error; NaN where there is none.
    """

    tie: float | None = None
    tie_error: float = math.nan
    left: float | None = None
    left_error: float = math.nan


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
        return without_strengths(votes, reason)
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
    rows[:count, : count - 1] = centring(count)
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
    errors = deviations(fit.clustered)
    return BradleyTerry(
        conditions=votes.conditions,
        **fitted(linked, fit, kind, votes.participant, votes.segment),
        tie=float(fit.estimates[count - 1]) if modelled else None,
        tie_error=float(errors[count - 1]) if modelled else math.nan,
        left=float(fit.estimates[-1]) if left else None,
        left_error=float(errors[-1]) if left else math.nan,
        n=fit.choices,
        participants=votes.participants,
        reason="" if fit.converged else "the strengths did not converge",
    )


def without_strengths(votes: Votes, reason: str) -> BradleyTerry:
    """Return a result without strengths, which says why there are none."""
    return BradleyTerry(
        conditions=votes.conditions,
        **unknown(len(votes.conditions)),
        n=len(votes.left),
        participants=votes.participants,
        reason=reason,
    )
