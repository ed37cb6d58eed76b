"""Distance of speed histograms: whether joints move as fast, as often, as recorded ones.

GENEA's evaluation (Kucherenko et al. 2021) compares how often each speed occurs, whenever it does,
by the Hellinger distance, which is 0 for equal histograms and 1 for ones without a common bin.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.joint_positions import UPPER_BODY_JOINTS
from analysis.metrics.result import Metric, MetricResult
from analysis.metrics.samples import FEWEST_CLIPS, SEED

FloatArray = NDArray[np.float64]
Counts = NDArray[np.int64]

BIN: Final = 0.05
"""Metres per second."""

_BINS: Final = 80
_RESAMPLES: Final = 200


def speed_counts(positions: FloatArray, frame_rate: float) -> Counts:
    """Return how many frames of a clip have each speed.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Metres.
    frame_rate : float
        Frames per second.

    Returns
    -------
    ndarray, shape (J, 80), int
        Frames by joint and speed, in bins of `BIN`; the last holds all that is faster.
    """
    speed = np.linalg.norm(np.diff(positions, axis=0), axis=2) * frame_rate
    place = np.minimum((speed / BIN).astype(np.int64), _BINS - 1)
    joints = positions.shape[1]
    flat = (place + _BINS * np.arange(joints)).reshape(-1)
    return np.bincount(flat, minlength=joints * _BINS).reshape(joints, _BINS)


def speed_distance(generated: Counts, recorded: Counts, *, frame_rate: float) -> MetricResult:
    """Return the Hellinger distance of the speed histograms of two sets of clips.

    Parameters
    ----------
    generated, recorded : ndarray, shape (C, J, 80), (D, J, 80), int
        `speed_counts` of each clip.
    frame_rate : float
        Frames per second of the clips.

    Returns
    -------
    MetricResult
        In [0, 1], mean over joints. The interval is the score ± 1.96 times its standard deviation
        when clips are drawn again. NaN without a clip of two frames on either side.
    """
    described = {
        "joints": ", ".join(UPPER_BODY_JOINTS),
        "frame rate": f"{frame_rate:g} fps",
        "distance": "Hellinger, mean over joints",
        "bins": f"{BIN:g} m/s, {_BINS} of them, the last open",
        "clips": f"{len(generated)} generated, {len(recorded)} recorded",
    }
    metric = Metric("distance of speed histograms (genea)", better="lower")
    if not (generated.any() and recorded.any()):
        reason = "a speed needs two frames of generated and of recorded motion"
        return metric.missing(reason, described)
    value = float(_hellinger(generated.sum(axis=0), recorded.sum(axis=0)))
    interval = None
    if min(len(generated), len(recorded)) >= FEWEST_CLIPS:
        described["interval"] = f"± 1.96 SD over {_RESAMPLES} bootstrap samples of clips"
        reach = 1.96 * _spread(generated, recorded)
        interval = (max(0.0, value - reach), min(1.0, value + reach))
    return metric.score(value, int(generated[:, 0].sum()), described, interval=interval)


def _hellinger(one: FloatArray | Counts, other: FloatArray | Counts) -> FloatArray:
    """Return the distances of histograms of shape (..., J, bins), mean over joints."""
    shares = [counts / counts.sum(axis=-1, keepdims=True) for counts in (one, other)]
    common = np.sqrt(shares[0] * shares[1]).sum(axis=-1)
    return np.asarray(np.sqrt(np.maximum(0, 1 - common)).mean(axis=-1))


def _spread(generated: Counts, recorded: Counts) -> float:
    """Return the standard deviation of the distance over bootstrap samples of clips."""
    chance = np.random.default_rng(SEED)
    drawn = []
    for counts in (generated, recorded):
        clips = len(counts)
        weights = chance.multinomial(clips, np.full(clips, 1 / clips), size=_RESAMPLES)
        drawn.append(np.tensordot(weights, counts, axes=1))
    return float(np.std(_hellinger(*drawn), ddof=1))
