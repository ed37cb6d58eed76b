"""Diversity: two different quantities that the literature gives one name.

`l1_deviation` asks how far one clip moves around its own mean pose, `mean_pair_distance` how far
the clips of one condition differ from each other. Both reward noise, so read them beside jerk.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]


def l1_deviation(
    values: FloatArray, *, unit: str = "m", settings: Mapping[str, str] | None = None
) -> MetricResult:
    """Return the mean L1 distance of a clip's frames from their mean (L1div).

    Parameters
    ----------
    values : ndarray, shape (T, ...)
        One pose per frame, in any representation.
    unit : str
        Unit of `values`.
    settings : mapping, optional
        What `values` are.

    Returns
    -------
    MetricResult
        Mean over frames of the sum over dimensions of absolute deviations (Li et al. 2021, as
        used by BEAT and EMAGE).
    """
    flat = values.reshape(len(values), -1)
    deviation = np.abs(flat - flat.mean(axis=0)).sum(axis=1)
    return MetricResult(
        name="deviation from the mean pose (L1div)",
        value=float(deviation.mean()),
        unit=unit,
        n=len(flat),
        settings=settings or {},
    )


def mean_pair_distance(
    features: FloatArray, *, unit: str = "m", settings: Mapping[str, str] | None = None
) -> MetricResult:
    """Return the mean Euclidean distance over all pairs of clips.

    Parameters
    ----------
    features : ndarray, shape (N, D)
        One vector per clip.
    unit : str
        Unit of `features`.
    settings : mapping, optional
        What `features` are.

    Returns
    -------
    MetricResult
        NaN for fewer than two clips.
    """
    name = "mean distance between clips"
    described = settings or {}
    if len(features) < 2:
        return MetricResult(
            name=name,
            value=math.nan,
            unit=unit,
            n=0,
            settings=described,
            reason="a distance needs two clips",
        )
    distances = pdist(features)
    return MetricResult(
        name=name, value=float(distances.mean()), unit=unit, n=len(distances), settings=described
    )


def motion_features(clips: Sequence[FloatArray]) -> FloatArray:
    """Return one vector per clip whose Euclidean distance is a root mean square in metres.

    Parameters
    ----------
    clips : sequence of ndarray, shape (T, J, 3)
        Joint positions of at least one clip; all are cut to the shortest.

    Returns
    -------
    ndarray, shape (N, T * J * 3)
        The distance of two rows is the root mean square, over frames and joints, of the distance
        between the clips' joints.
    """
    frames = min(len(clip) for clip in clips)
    joints = clips[0].shape[1]
    stacked = np.stack([clip[:frames].reshape(-1) for clip in clips])
    return stacked / math.sqrt(frames * joints)
