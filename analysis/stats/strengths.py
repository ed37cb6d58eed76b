"""Fitted strengths, and what comparisons can tell of them: who is linked, and who never lost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from analysis.stats.choices import ChoiceFit
from analysis.stats.strength_differences import ONE_PARTICIPANT, TwoWayErrors, deviations
from motion.errors import listed

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """How conditions are linked by comparisons.

    Attributes
    ----------
    tiers : ndarray of int, shape (conditions,)
        Conditions of one tier are linked by wins both ways. Of two tiers, one never lost to the
        other: their difference has no finite maximum-likelihood estimate (Ford 1957).
    apart : str
        Why there is no common scale, naming the groups that were never compared with one
        another; empty where all are linked.
    swept : str
        Which conditions never lost to which; empty where there is one tier.
    """

    tiers: Codes
    apart: str
    swept: str


def links(beats: Floats, names: Sequence[str]) -> Links:
    """Return how conditions are linked.

    Parameters
    ----------
    beats : ndarray, shape (conditions, conditions)
        How often the row's condition was preferred to the column's; a tie counts for both.
    names : sequence of str
        The conditions' names.
    """
    groups, group = connected_components(csr_matrix(beats + beats.T), directed=False)
    count, tiers = connected_components(csr_matrix(beats), directed=True, connection="strong")
    apart = ""
    if groups > 1:
        parts = [_named(names, group == number) for number in range(groups)]
        apart = (
            f"never compared with one another, not even through others: {' | '.join(parts)}; "
            "strengths have no common scale"
        )
    swept = []
    for number in range(count if count > 1 and not apart else 0):
        inside = tiers == number
        if not beats[~inside][:, inside].any():
            swept.append(f"{_named(names, inside)} never lost to any of the others")
    return Links(tiers=np.asarray(tiers, np.intp), apart=apart, swept="; ".join(swept))


def _named(names: Sequence[str], chosen: NDArray[np.bool_]) -> str:
    return listed([name for name, yes in zip(names, chosen, strict=True) if yes])


@dataclass(frozen=True, kw_only=True)
class Strengths:
    """Strengths, or worths, on the log scale; they add up to zero.

    Attributes
    ----------
    conditions : tuple of str
        In the order of everything else.
    strengths : ndarray, shape (conditions,)
        Log strengths; NaN where they are not identified.
    covariance : ndarray, shape (conditions, conditions)
        Of the strengths, clustered by participant (CR0).
    errors, errors_by_model : ndarray, shape (conditions,)
        Standard errors: clustered by participant; of the model.
    two_way : TwoWayErrors or None
        Errors clustered by participant and segment; None where segments are not known, or there
        is one of either.
    log_likelihood : float
        At the estimates.
    n, participants : int
        Answers, or rankings, and who gave them.
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
    two_way: TwoWayErrors | None = None
    log_likelihood: float = math.nan
    n: int
    participants: int
    tiers: Codes
    swept: str = ""
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


def centring(count: int) -> Floats:
    """Return what makes strengths that add up to zero from those relative to the first one."""
    return np.asarray(np.eye(count)[:, 1:] - 1 / count)


def fitted(
    linked: Links, fit: ChoiceFit, kind: Codes | None, participants: Codes, segments: Codes | None
) -> dict[str, Any]:
    """Return what a fit says of strengths, and how well they are known: fields of `Strengths`.

    Parameters
    ----------
    linked : Links
        How the conditions are linked.
    fit : ChoiceFit
        Of the other conditions' log strengths, and then of other parameters.
    kind, participants, segments : ndarray of int, shape (N,), or None
        Each answer's row among `fit.influences`, who gave it, and about which segment; without
        one of them there are no two-way errors.
    """
    free = len(linked.tiers) - 1
    turn = centring(free + 1)
    clustered, by_model = (
        turn @ part[:free, :free] @ turn.T for part in (fit.clustered, fit.by_model)
    )
    influences = fit.influences[:, :free] @ turn.T
    return {
        "strengths": turn @ fit.estimates[:free],
        "covariance": clustered,
        "errors": deviations(clustered),
        "errors_by_model": deviations(by_model),
        "two_way": None
        if kind is None or segments is None
        else TwoWayErrors.of(influences, fit.situation, kind, participants, segments),
        "log_likelihood": fit.log_likelihood,
        "tiers": linked.tiers,
        "swept": linked.swept,
    }


def unknown(count: int) -> dict[str, Any]:
    """Return the fields of `Strengths` of so many conditions whose strengths are not known."""
    none = np.full(count, math.nan)
    errors = dict.fromkeys(("strengths", "errors", "errors_by_model"), none)
    return errors | {
        "covariance": np.full((count, count), math.nan),
        "tiers": np.zeros(count, np.intp),
    }
