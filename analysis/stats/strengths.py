"""Fitted strengths, and which of them comparisons identify: links, and who never lost."""

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
from analysis.stats.strength_differences import ONE_PARTICIPANT, TwoWayErrors, standard_errors
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
    unlinked : str
        Why there is no common scale, naming the groups that were never compared with one
        another; empty where all are linked.
    swept : str
        Which conditions never lost to which; empty where there is one tier.
    """

    tiers: Codes
    unlinked: str
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
    unlinked = ""
    if groups > 1:
        parts = [_named(names, group == number) for number in range(groups)]
        unlinked = (
            f"never compared with one another, not even through others: {' | '.join(parts)}; "
            "strengths have no common scale"
        )
    swept = []
    for number in range(count if count > 1 and not unlinked else 0):
        inside = tiers == number
        if not beats[~inside][:, inside].any():
            swept.append(f"{_named(names, inside)} never lost to any of the others")
    return Links(tiers=np.asarray(tiers, np.intp), unlinked=unlinked, swept="; ".join(swept))


def _named(names: Sequence[str], chosen: NDArray[np.bool_]) -> str:
    return listed([name for name, yes in zip(names, chosen, strict=True) if yes])


@dataclass(frozen=True, kw_only=True)
class FittedStrengths:
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
        Errors clustered by participant and segment; None where there are no strengths, or there
        is one participant.
    log_likelihood : float
        At the estimates.
    n, participants : int
        Answers, or rankings, and who gave them.
    tiers : ndarray of int, shape (conditions,)
        See `Links`; of one tier unless `swept` says who never lost, where the fit is penalised.
    swept : str
        Which conditions never lost to which; empty where every one did.
    reason : str
        Why there are no strengths, so that every number is NaN; empty where there are. `remark`
        says why they have no errors.
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
        if self.two_way is None:
            return np.full(len(self.conditions), math.nan)
        return self.two_way.errors


def centring(count: int) -> Floats:
    """Return the matrix from strengths relative to the first to ones that add up to zero."""
    return np.asarray(np.eye(count)[:, 1:] - 1 / count)


def strength_fields(
    linked: Links, fit: ChoiceFit, kind: Codes, participants: Codes, segments: Codes
) -> dict[str, Any]:
    """Return the fields of `FittedStrengths` that follow from a fit.

    Parameters
    ----------
    linked : Links
        How the conditions are linked.
    fit : ChoiceFit
        Of the log strengths of all conditions but the first, followed by other parameters.
    kind, participants, segments : ndarray of int, shape (N,)
        Each answer's row in `fit.influences`, who gave it, and about which segment.
    """
    free = len(linked.tiers) - 1
    centre = centring(free + 1)
    clustered, by_model = (
        centre @ covariance[:free, :free] @ centre.T for covariance in (fit.clustered, fit.by_model)
    )
    influences = fit.influences[:, :free] @ centre.T
    return {
        "strengths": centre @ fit.estimates[:free],
        "covariance": clustered,
        "errors": standard_errors(clustered),
        "errors_by_model": standard_errors(by_model),
        "two_way": TwoWayErrors.of(influences, fit.situation, kind, participants, segments),
        "log_likelihood": fit.log_likelihood,
        "tiers": linked.tiers,
        "swept": linked.swept,
    }


def unknown_strengths(count: int) -> dict[str, Any]:
    """Return the fields of `FittedStrengths` of `count` conditions that have no strengths."""
    missing = np.full(count, math.nan)
    errors = dict.fromkeys(("strengths", "errors", "errors_by_model"), missing)
    return errors | {
        "covariance": np.full((count, count), math.nan),
        "tiers": np.zeros(count, np.intp),
    }
