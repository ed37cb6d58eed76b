"""Diversity: three different quantities to which papers give one name.

`l1_deviation` is how far one clip moves around its own mean pose, `mean_pair_distance` how far the
clips of a condition differ from each other, and `feature_variance` the same for their embeddings.
All reward noise, so read them together with jerk and compare them with recorded motion.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.distance import pdist

from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Floats


def l1_deviation(values: Floats, *, settings: Mapping[str, str] | None = None) -> MetricResult:
    """Return the mean L1 distance of a clip's frames from their mean (L1div).

    Parameters
    ----------
    values : ndarray, shape (T, ...)
        One pose per frame, positions in metres.
    settings : mapping, optional
        Settings that `values` were computed with.

    Returns
    -------
    MetricResult
        Mean over frames of the sum over dimensions of absolute deviations (Li et al. 2021, as
        used by BEAT and EMAGE).
    """
    flat = values.reshape(len(values), -1)
    deviation = np.abs(flat - flat.mean(axis=0)).sum(axis=1)
    metric = Metric("deviation from the mean pose (L1div)", "m", "near the reference")
    return metric.score(float(deviation.mean()), len(flat), settings)


def mean_pair_distance(
    features: Floats,
    *,
    name: str = "mean distance between clips",
    unit: str = "m",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the mean Euclidean distance over all pairs of clips.

    Parameters
    ----------
    features : ndarray, shape (N, D)
        One vector per clip.
    name : str
        Names the metric.
    unit : str
        Unit of `features`.
    settings : mapping, optional
        Settings that `features` were computed with.

    Returns
    -------
    MetricResult
        NaN for fewer than two clips.
    """
    metric = Metric(name, unit, "near the reference")
    count = len(features)
    if count < 2:
        return metric.missing("a distance needs two clips", settings)
    return metric.score(float(pdist(features).mean()), count * (count - 1) // 2, settings)


def feature_variance(
    features: Floats,
    *,
    name: str = "variance of features",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the variance of the clips' embeddings, which is AMUSE's diversity.

    Parameters
    ----------
    features : ndarray, shape (N, D)
        One embedding per clip.
    name : str
        Names the metric.
    settings : mapping, optional
        The feature network and its hash.

    Returns
    -------
    MetricResult
        Unbiased variance over clips, mean over dimensions (Chhatre et al. 2024, section 5.1, which
        leaves open whether it is their mean or sum), in squared units of the embeddings. NaN for
        fewer than two clips.
    """
    metric = Metric(name, better="near the reference")
    description = dict(settings or {}) | {"mean over": f"{features.shape[1]} dimensions"}
    if len(features) < 2:
        return metric.missing("a variance needs two clips", description)
    return metric.score(float(features.var(axis=0, ddof=1).mean()), len(features), description)


def motion_features(clips: Sequence[Floats]) -> Floats:
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
