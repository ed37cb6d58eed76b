"""The clustered mean's test of many studies at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse, stats

from analysis.stats.clustered_variance import freedom_of, one_way

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """What tests say, study by study.

    Attributes
    ----------
    p_values : ndarray, shape (studies, tests)
        NaN where a test cannot be made.
    signs : ndarray, shape (studies, tests)
        Above 0 where the first of the two conditions comes out better.
    """

    p_values: Floats
    signs: Floats


def clustered_tests(values: Floats, participants: Codes, items: Codes) -> tuple[Floats, Floats]:
    """Test whether the means of many studies of one design are zero.

    The same as `analysis.stats.clustered_mean.clustered_mean` of each row.

    Parameters
    ----------
    values : ndarray, shape (studies, N)
        What was answered, as far as it differs from nothing.
    participants, items : ndarray of int, shape (N,)
        Who answered about what.

    Returns
    -------
    tuple of ndarray, shape (studies,)
        The means, and the two-sided p values; NaN where a study has no test.
    """
    studies, count = values.shape
    groups = [np.unique(codes, return_inverse=True)[1] for codes in (participants, items)]
    sizes = [int(codes.max(initial=-1)) + 1 for codes in groups]
    if not count or sizes[0] < 2:
        means = values.mean(axis=1) if count else np.full(studies, np.nan)
        return means, np.full(studies, np.nan)
    means = values.mean(axis=1)
    influences = (values - means[:, None]).T / count
    cells = np.unique(groups[0] * sizes[1] + groups[1], return_inverse=True)[1]
    ways = [(codes, np.bincount(codes) / count) for codes in (*groups, cells)]
    if sizes[1] < 2:
        ways = [ways[0]] * 3
    by_participant, by_item, by_cell = (_variances(influences, *way) for way in ways)
    independent = (influences**2).sum(axis=0)
    variances = np.maximum.reduce([by_participant + by_item - by_cell, by_participant, by_item])
    rounding = variances <= 1e-12 * count * independent
    variances[rounding] = independent[rounding] * count / (count - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        distance = np.abs(means) / np.sqrt(variances)
    p_values = 2 * stats.t(min(float(freedom_of(shares)) for _, shares in ways[:2])).sf(distance)
    p_values[np.ptp(values, axis=1) == 0] = np.nan
    return means, np.asarray(p_values, np.float64)


def _variances(influences: Floats, codes: Codes, shares: Floats) -> Floats:
    table = sparse.csr_array(
        (np.ones(len(codes)), (codes, np.arange(len(codes)))), (len(shares), len(codes))
    )
    sums = np.asarray(table @ influences, np.float64)
    return one_way(sums, shares[:, None])[0]
