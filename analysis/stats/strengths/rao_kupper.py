"""Rao & Kupper's model of pairwise preferences: a tie is a difference too small to be seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from analysis.stats.ordinal.links import interval
from analysis.stats.ordinal.maximum import second_derivatives
from analysis.stats.strengths.bradley_terry import BradleyTerry, centred, without_strengths
from analysis.stats.strengths.choices import ChoiceFit, sandwiches
from analysis.stats.strengths.fitted import links
from analysis.stats.strengths.votes import Votes

Floats = NDArray[np.float64]


def rao_kupper(votes: Votes, *, left: bool = True) -> BradleyTerry:
    """Fit Bradley-Terry strengths with Rao & Kupper's (1967) ties.

    With strengths p and a threshold theta > 1, one condition beats another with probability
    p / (p + theta p_other): the logistic difference of log strengths must be above log theta.

    Returns
    -------
    BradleyTerry
        `tie` is log theta.
    """
    linked = links(votes.beats, votes.conditions)
    reason = (linked.apart or linked.swept) if len(votes.left) else "no answers"
    if not reason and not (votes.outcome == 0).any():
        reason = "there is no tie, so that the size of an unseen difference has no estimate"
    if reason:
        return without_strengths(votes, reason)
    count = len(votes.conditions)
    cells, cell = np.unique(
        (votes.left * count + votes.right) * 3 + (1 - votes.outcome), return_inverse=True
    )
    design = _design(cells, count, left)
    counts = np.bincount(cell, minlength=len(cells)).astype(np.float64)

    def descent(parameters: Floats) -> tuple[float, Floats]:
        logs, scores = _cells(cells % 3, design, parameters, count)
        return -float(counts @ logs) / len(cell), -(counts @ scores) / len(cell)

    start = np.zeros(design.shape[1])
    start[count - 1] = np.log(0.4)
    found = minimize(descent, start, jac=True, method="BFGS", options={"gtol": 1e-9})
    parameters = np.asarray(found.x, np.float64)
    hessian = len(cell) * second_derivatives(lambda at: descent(at)[1], parameters)
    _, scores = _cells(cells % 3, design, parameters, count)
    bread = np.asarray(np.linalg.inv(hessian), np.float64)
    robust, clustered = sandwiches(bread, scores, cell.astype(np.intp), votes.participant)
    # The threshold was found by its logarithm; it is reported itself.
    turn = np.ones(len(parameters))
    turn[count - 1] = np.exp(parameters[count - 1])
    scale = np.outer(turn, turn)
    parameters[count - 1] = turn[count - 1]
    fit = ChoiceFit(
        estimates=parameters,
        by_model=scale * bread,
        robust=scale * robust,
        clustered=scale * clustered,
        influences=turn * (scores @ bread),
        situation=(cells // 3).astype(np.intp),
        log_likelihood=-float(found.fun) * len(cell),
        choices=len(cell),
        clusters=int(votes.participant.max()) + 1,
        converged=bool(np.abs(found.jac).max() < 1e-6),
    )
    return centred(votes, fit, cell.astype(np.intp), linked, modelled=True, left=left)


def _design(cells: NDArray[np.intp], count: int, left: bool) -> Floats:
    """Return what each parameter adds to left minus right; nothing for the threshold."""
    pairs = cells // 3
    strengths = np.eye(count)
    difference = strengths[pairs // count] - strengths[pairs % count]
    columns = [difference[:, 1:], np.zeros((len(cells), 1))]
    return np.concatenate([*columns, np.ones((len(cells), 1))] if left else columns, axis=1)


def _cells(
    outcome: NDArray[np.intp], design: Floats, parameters: Floats, count: int
) -> tuple[Floats, Floats]:
    """Return each cell's log probability and its gradient; outcomes are left, tie and right."""
    threshold = np.exp(parameters[count - 1])
    difference = design @ parameters
    lower = np.choose(outcome, [threshold, -threshold, -np.inf]) - difference
    upper = np.choose(outcome, [np.inf, threshold, -threshold]) - difference
    ends = interval(lower, upper, "logit")
    upper, lower = ends.by_upper[0], ends.by_lower[0]
    scores = ends.slope[:, None] * design
    by_threshold = np.choose(outcome, [lower, upper - lower, -upper])
    scores[:, count - 1] = by_threshold * threshold
    return ends.log_probability, scores
