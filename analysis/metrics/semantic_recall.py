"""Semantic-relevant gesture recall (SRGR): correct motion, counted where gestures carry meaning.

Published code multiplies by a constant (1 / 0.165) in place of the mean weight, so that its values
depend on the excerpt and may exceed 1. Here the weighted mean is divided by the sum of the weights.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.correct_motion import CorrectSettings, correct_joints
from analysis.metrics.pairing import paired
from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]


def semantic_recall(
    generated: FloatArray,
    recorded: FloatArray,
    weights: FloatArray,
    *,
    settings: CorrectSettings,
) -> MetricResult:
    """Return the share of correct joints, weighted by how much each frame's gesture means.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, J, 3)
        In the representation of `settings`, at one frame rate.
    weights : ndarray, shape (T,)
        Semantic score of each frame, at least 0; of the longer clip where they differ.
    settings : CorrectSettings
        Usually one of the presets of `analysis.metrics.correct_motion`.

    Returns
    -------
    MetricResult
        In [0, 1]. NaN where the clips do not pair or no frame has a weight.

    Raises
    ------
    ValueError
        If there are fewer weights than frames, or one is negative or not finite.
    """
    one, other, reason = paired(generated, recorded)
    if len(weights) < len(one):
        raise ValueError(f"{len(weights)} weights for {len(one)} frames")
    if not (np.isfinite(weights) & (weights >= 0)).all():
        raise ValueError("a weight is negative or not finite")
    used = weights[: len(one)]
    if not reason and not one.shape[1]:
        reason = "no joint moves in the recordings"
    if not reason and not used.sum() > 0:
        reason = "no frame has a semantic score above 0"
    value = math.nan
    if not reason:
        wrong = 1 - correct_joints(one, other, settings).mean(axis=1)
        value = max(0.0, 1 - float(wrong @ used / used.sum()))  # rounding never leaves [0, 1]
    return MetricResult(
        name=f"semantic-relevant gesture recall ({settings.name})",
        value=value,
        unit="",
        n=0 if reason else int(np.count_nonzero(used)) * one.shape[1],
        settings=settings.described() | {"weights": "semantic scores, divided by their sum"},
        reason=reason,
        better="higher",
    )
