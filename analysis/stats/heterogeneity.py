"""An effect within each emotion, segment or speaker, and whether it is the same in all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse, stats

from analysis.stats.clustered_mean import UNTESTED, Estimate, clustered_mean
from analysis.stats.min_f import FTest, joined
from analysis.stats.values import group_means

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

MIN_F: Final = (
    "min F′ of groups within participants and of groups between segments; participants and "
    "segments are samples"
)
WITHIN: Final = (
    "F of segments within participants; answers of one participant have a level in common and are "
    "otherwise taken as independent"
)

NOTHING: Final = 1e-12
"""Share of a variance below which it is rounding."""


FEW: Final = 3
"""Segments up to which a cell is described and not tested."""


@dataclass(frozen=True, kw_only=True)
class Cell(Estimate):
    """The effect within one emotion, segment or speaker.

    Attributes
    ----------
    level : str
        Which one.
    descriptive : bool
        Whether it rests on so few segments that it is described and not tested: it says nothing
        about others of its kind, and `p_value` is NaN.
    p_holm : float
        `p_value`, corrected over all such tests of a report.
    """

    level: str
    descriptive: bool
    p_holm: float = math.nan


def cells(
    values: Floats,
    levels: Codes,
    names: Sequence[str],
    participants: Codes,
    segments: Codes,
    *,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> tuple[Cell, ...]:
    """Estimate an effect within each level that has answers.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per answer; their mean is the effect.
    levels : ndarray of int, shape (N,)
        Which emotion, segment or speaker each is about, a place in `names`.
    names : sequence of str
        Of the levels.
    participants, segments : ndarray of int, shape (N,)
        Who answered about which segment.
    null : float
        The effect of none.
    limits : (float, float)
        Where values can lie.

    Returns
    -------
    tuple of Cell
        In the order of `names`.
    """
    order = np.argsort(levels, kind="stable")
    found, starts = np.unique(levels[order], return_index=True)
    return tuple(
        _cell(names[level], values[own], participants[own], segments[own], null, limits)
        for level, own in zip(found, np.split(order, starts[1:]), strict=True)
    )


def _cell(
    name: str,
    values: Floats,
    participants: Codes,
    segments: Codes,
    null: float,
    limits: tuple[float, float],
) -> Cell:
    mean = clustered_mean(values, participants, segments, null=null, limits=limits)
    count = mean.segments
    if descriptive := count <= FEW:
        untested = f"{count} segment{'s' * (count > 1)}: {UNTESTED}"
        remark = "; ".join(filter(None, (untested, mean.remark)))
        mean = replace(mean, p_value=math.nan, remark=remark)
    return Cell(**vars(mean), level=name, descriptive=descriptive)


def between_groups(values: Floats, groups: Codes, participants: Codes, segments: Codes) -> FTest:
    """Test whether emotions or speakers differ; each holds several segments (Clark 1973).

    One F compares the groups with how differently participants take them, over those who answered
    about all; the other with how much the segments of one group differ. min F′ lets both
    participants and segments be samples, and is conservative.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers.
    groups, participants, segments : ndarray of int, shape (N,)
        Which group each is about, who gave it, and which segment it is about.
    """
    group = np.unique(groups, return_inverse=True)[1]
    count = int(group.max(initial=-1)) + 1
    if count < 2:
        return FTest(reason="fewer than two groups")
    by_person = _complete_means(values, group, participants, count)
    units = np.unique(segments * count + group, return_inverse=True)[1]
    by_segment = group_means(values, units)
    of_segment = group_means(group.astype(np.float64), units).astype(np.intp)
    rest = len(by_segment) - count
    if len(by_person) < 2:
        return FTest(reason="fewer than two participants answered about every group")
    if rest < 1:
        return FTest(reason="one segment in every group")
    people_f = _within_people(by_person)
    segments_f = _one_way(by_segment, of_segment, rest)
    if math.isnan(people_f) or math.isnan(segments_f):
        return FTest(reason="all answers alike")
    noise = [1 / f if f else math.inf for f in (people_f, segments_f)]
    if not sum(noise):
        return FTest(reason="all answers of a group alike")
    rests = (count - 1) * (len(by_person) - 1), rest
    return joined(noise, count - 1, rests, df_of_zero=min(rests), method=MIN_F)


def between_segments(values: Floats, participants: Codes, segments: Codes) -> FTest:
    """Test whether segments differ beyond the differences of those who answered about them.

    The segments are those of the study; several answers of one participant about a segment count
    as their mean. Not all participants need to have answered about all (Scheffé 1959, ch. 4).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers.
    participants, segments : ndarray of int, shape (N,)
        Who gave each, about which segment.
    """
    who = np.unique(participants, return_inverse=True)[1]
    what = np.unique(segments, return_inverse=True)[1]
    count = int(what.max(initial=-1)) + 1
    if count < 2:
        return FTest(reason="one segment")
    cells, cell = np.unique(who * count + what, return_inverse=True)
    y, who, what = group_means(values, cell), cells // count, cells % count
    y = y - y.mean()
    table = sparse.coo_array((np.ones(len(y)), (who, what))).tocsr()
    by_person = np.asarray(table.sum(axis=1)).ravel()
    person_means = np.bincount(who, weights=y) / by_person
    within = float(y @ y - by_person @ person_means**2)
    # Segments with participants taken out: normal equations of the additive model.
    shared = (table.T @ (table / by_person[:, None])).toarray()
    design = np.diag(np.bincount(what).astype(np.float64)) - shared
    right = np.bincount(what, weights=y) - table.T @ person_means
    freedom = int(np.linalg.matrix_rank(design, hermitian=True))
    explained = float(right @ np.linalg.lstsq(design, right, rcond=None)[0])
    rest = len(y) - len(by_person) - freedom
    if freedom < 1 or rest < 1:
        return FTest(reason="too few participants share segments to tell them apart")
    noise = within - explained
    if noise <= NOTHING * float(y @ y):
        return FTest(reason="participants differ alike in every segment")
    statistic = max(0.0, explained) / freedom / (noise / rest)
    return FTest(
        statistic=statistic,
        df=freedom,
        df_rest=rest,
        p_value=float(stats.f.sf(statistic, freedom, rest)),
        method=WITHIN,
    )


def _complete_means(values: Floats, group: Codes, participants: Codes, count: int) -> Floats:
    """Return the means by participant and group, of those who answered about every group."""
    who = np.unique(participants, return_inverse=True)[1]
    place = who * count + group
    size = (int(who.max(initial=-1)) + 1) * count
    times = np.bincount(place, minlength=size).reshape(-1, count)
    sums = np.bincount(place, weights=values, minlength=size).reshape(-1, count)
    complete = (times > 0).all(axis=1)
    return np.asarray(sums[complete] / times[complete], np.float64)


def _within_people(means: Floats) -> float:
    """Return F of the columns against how differently rows take them; NaN where all are alike."""
    people, count = means.shape
    centred = means - means.mean(axis=1, keepdims=True)
    columns = centred.mean(axis=0)
    between = people * float(columns @ columns) / (count - 1)
    rest = float(((centred - columns) ** 2).sum()) / ((count - 1) * (people - 1))
    return _ratio(between, rest, float((centred**2).sum()))


def _one_way(means: Floats, group: Codes, rest: int) -> float:
    """Return F between groups of segments' means; NaN where all are alike."""
    sizes = np.bincount(group)
    centres = np.bincount(group, weights=means) / sizes
    spread = float(((means - means.mean()) ** 2).sum())
    inside = float(((means - centres[group]) ** 2).sum())
    return _ratio((spread - inside) / (len(sizes) - 1), inside / rest, spread)


def _ratio(between: float, rest: float, total: float) -> float:
    """Return a quotient of variances, of which rounding is none."""
    if not total:
        return math.nan
    if between <= NOTHING * total:
        return 0.0
    return math.inf if rest <= NOTHING * total else between / rest
