"""F tests over participants and items: min F′, and differences between groups and items."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse, stats

from analysis.stats.samples import ROUNDING, group_means
from motion.arrays import Floats, Indices

MIN_F: Final = (
    "min F′ of groups within participants and of groups between segments; participants and "
    "segments are samples"
)
WITHIN: Final = (
    "F of segments within participants; answers of one participant have a level in common and are "
    "otherwise taken as independent"
)

NOTHING: Final = 1e-12
"""Share of a variance below which it is a rounding error."""


@dataclass(frozen=True, kw_only=True)
class FTest:
    """An F test; every number is NaN without a test.

    Attributes
    ----------
    statistic : float
        F.
    df, df_rest : float
        Degrees of freedom of the numerator and of the denominator.
    p_value : float
        p-value for no difference.
    method, reason : str
        The kind of test; why there is none.
    """

    statistic: float = math.nan
    df: float = math.nan
    df_rest: float = math.nan
    p_value: float = math.nan
    method: str = ""
    reason: str = ""


def min_f(values: Floats, participants: NDArray[np.generic], items: NDArray[np.generic]) -> FTest:
    """Test whether the mean of `values` is zero (Clark 1973).

    It is conservative: its false positive rate is below its level. F1 and F2 are the squares of the
    one-sample t over participants' and items' means.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Net preference of each answer, 0 for none.
    participants, items : ndarray, shape (N,)
        The participant and the item of each answer.
    """
    means = group_means(values, participants), group_means(values, items)
    for group_mean, name in zip(means, ("participant", "segment"), strict=True):
        if len(group_mean) < 2:
            return FTest(reason=f"one {name}" if len(group_mean) else "no answers")
    if not values.any():
        return FTest(reason="all answers are zero")
    variances = [_variance(group_mean) for group_mean in means]
    if not sum(variances):
        return FTest(reason="all answers alike")
    dfs_rest = len(means[0]) - 1, len(means[1]) - 1
    noise = [1 / f if f else math.inf for f in map(_f, means, variances)]
    return combine(noise, 1, dfs_rest, df_of_zero=_df(variances, dfs_rest))


def combine(
    noise: Sequence[float],
    df: int,
    dfs_rest: Sequence[float],
    *,
    df_of_zero: float,
    method: str = "",
) -> FTest:
    """Combine two F tests of one difference into min F′ = 1 / (1 / F1 + 1 / F2).

    Parameters
    ----------
    noise : sequence of float
        1 / F1 and 1 / F2, at least one of them above zero; infinite if there is no difference.
    df : int
        Degrees of freedom of the difference.
    dfs_rest : sequence of float
        Degrees of freedom of each denominator.
    df_of_zero : float
        Degrees of freedom of min F′ if it is zero.
    """
    if math.isinf(sum(noise)):
        return FTest(statistic=0.0, df=df, df_rest=df_of_zero, p_value=1.0, method=method)
    statistic, df_rest = 1 / sum(noise), _df(noise, dfs_rest)
    p_value = float(stats.f.sf(statistic, df, df_rest))
    return FTest(statistic=statistic, df=df, df_rest=df_rest, p_value=p_value, method=method)


def _variance(means: Floats) -> float:
    """Return the variance of the mean of `means`; 0 if they are equal but for rounding."""
    if float(np.ptp(means)) <= ROUNDING * float(np.abs(means).max()):
        return 0.0
    return float(means.var(ddof=1)) / len(means)


def _f(means: Floats, variance: float) -> float:
    """Return the square of t of the mean of `means`."""
    centre = float(means.mean())
    if abs(centre) <= ROUNDING * float(np.abs(means).max()):
        return 0.0
    return centre**2 / variance if variance else math.inf


def _df(variances: Sequence[float], dfs_rest: Sequence[float]) -> float:
    """Return the degrees of freedom of a sum of two variances (Satterthwaite 1946)."""
    squares = (variance**2 / df_rest for variance, df_rest in zip(variances, dfs_rest, strict=True))
    return float(sum(variances) ** 2 / sum(squares))


def between_groups(
    values: Floats, groups: Indices, participants: Indices, segments: Indices
) -> FTest:
    """Test whether emotions or speakers differ; each holds several segments (Clark 1973).

    One F compares the groups with their interaction with participants who answered about all
    groups, the other with the variance of segments within groups. min F′ treats both participants
    and segments as samples, and is conservative.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers.
    groups, participants, segments : ndarray of int, shape (N,)
        The group (of at least two), the participant and the segment of each answer.
    """
    group = np.unique(groups, return_inverse=True)[1]
    count = int(group.max(initial=-1)) + 1
    by_person = _complete_means(values, group, participants, count)
    units = np.unique(segments * count + group, return_inverse=True)[1]
    by_segment = group_means(values, units)
    of_segment = group_means(group.astype(np.float64), units).astype(np.intp)
    df_rest = len(by_segment) - count
    if len(by_person) < 2:
        return FTest(reason="fewer than two participants answered about every group")
    if df_rest < 1:
        return FTest(reason="one segment in every group")
    participants_f = _within_participants(by_person)
    segments_f = _one_way(by_segment, of_segment, df_rest)
    if math.isnan(participants_f) or math.isnan(segments_f):
        return FTest(reason="all answers alike")
    noise = [1 / f if f else math.inf for f in (participants_f, segments_f)]
    if not sum(noise):
        return FTest(reason="all answers of a group alike")
    dfs_rest = (count - 1) * (len(by_person) - 1), df_rest
    return combine(noise, count - 1, dfs_rest, df_of_zero=min(dfs_rest), method=MIN_F)


def between_segments(values: Floats, participants: Indices, segments: Indices) -> FTest:
    """Test whether segments differ beyond the differences between their participants.

    The study's segments are fixed; several answers of one participant about a segment count as
    their mean. Participants need not have answered about all segments (Scheffé 1959, ch. 4).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers.
    participants, segments : ndarray of int, shape (N,)
        The participant and the segment of each answer.
    """
    person = np.unique(participants, return_inverse=True)[1]
    segment = np.unique(segments, return_inverse=True)[1]
    count = int(segment.max(initial=-1)) + 1
    cells, cell = np.unique(person * count + segment, return_inverse=True)
    y, person, segment = group_means(values, cell), cells // count, cells % count
    y = y - y.mean()
    table = sparse.coo_array((np.ones(len(y)), (person, segment))).tocsr()
    by_person = np.asarray(table.sum(axis=1)).ravel()
    person_means = np.bincount(person, weights=y) / by_person
    within = float(y @ y - by_person @ person_means**2)
    # Segments adjusted for participants: normal equations of the additive model.
    shared = (table.T @ (table / by_person[:, None])).toarray()
    design = np.diag(np.bincount(segment).astype(np.float64)) - shared
    target = np.bincount(segment, weights=y) - table.T @ person_means
    df = int(np.linalg.matrix_rank(design, hermitian=True))
    explained = float(target @ np.linalg.lstsq(design, target, rcond=None)[0])
    df_rest = len(y) - len(by_person) - df
    if df < 1 or df_rest < 1:
        return FTest(reason="too few participants share segments to tell them apart")
    noise = within - explained
    if noise <= NOTHING * float(y @ y):
        return FTest(reason="participants differ alike in every segment")
    statistic = max(0.0, explained) / df / (noise / df_rest)
    return FTest(
        statistic=statistic,
        df=df,
        df_rest=df_rest,
        p_value=float(stats.f.sf(statistic, df, df_rest)),
        method=WITHIN,
    )


def _complete_means(values: Floats, group: Indices, participants: Indices, count: int) -> Floats:
    """Return means by participant and group, for participants who answered about every group."""
    person = np.unique(participants, return_inverse=True)[1]
    cell = person * count + group
    size = (int(person.max(initial=-1)) + 1) * count
    counts = np.bincount(cell, minlength=size).reshape(-1, count)
    sums = np.bincount(cell, weights=values, minlength=size).reshape(-1, count)
    complete = (counts > 0).all(axis=1)
    return np.asarray(sums[complete] / counts[complete], np.float64)


def _within_participants(means: Floats) -> float:
    """Return F of the columns against their interaction with rows; NaN if all are equal."""
    participants, count = means.shape
    centred = means - means.mean(axis=1, keepdims=True)
    columns = centred.mean(axis=0)
    between = participants * float(columns @ columns) / (count - 1)
    residual = float(((centred - columns) ** 2).sum()) / ((count - 1) * (participants - 1))
    return _ratio(between, residual, float((centred**2).sum()))


def _one_way(means: Floats, group: Indices, df_rest: int) -> float:
    """Return F between groups of segments' means; NaN if all are equal."""
    sizes = np.bincount(group)
    centres = np.bincount(group, weights=means) / sizes
    spread = float(((means - means.mean()) ** 2).sum())
    inside = float(((means - centres[group]) ** 2).sum())
    return _ratio((spread - inside) / (len(sizes) - 1), inside / df_rest, spread)


def _ratio(between: float, residual: float, total: float) -> float:
    """Return a quotient of variances; differences due to rounding count as none."""
    if not total:
        return math.nan
    if between <= NOTHING * total:
        return 0.0
    return math.inf if residual <= NOTHING * total else between / residual
