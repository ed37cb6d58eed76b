"""Percent of correct motion (PCM): the share of joints near their recorded value.

Papers use one name for different thresholds in different units (Chen et al. 2024, DiffSHEG, on
normalised rotations; Liu et al. 2022, BEAT, on Euler angles; Liu et al. 2024, EMAGE, on positions),
so each preset fixes both.

Semantic-relevant gesture recall (SRGR) is PCM weighted by how meaningful each gesture is. Published
code multiplies by a constant (1 / 0.165) in place of the mean weight, so its values depend on the
excerpt and may exceed 1. Here the weighted mean is divided by the sum of the weights.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from analysis.metrics.point_errors import paired
from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Bools, Floats

Representation = Literal["positions", "normalised rotations", "euler angles"]

_WORDS: Final[Mapping[Representation, str]] = {
    "positions": "positions relative to the pelvis, default body, metres",
    "normalised rotations": "axis-angle less the recordings' mean, over their standard deviation",
    "euler angles": "Euler angles XYZ, degrees",
}


@dataclass(frozen=True, kw_only=True)
class CorrectSettings:
    """The choices that define a joint's motion as correct.

    Attributes
    ----------
    name : str
        Name of the preset.
    representation : {'positions', 'normalised rotations', 'euler angles'}
        The three channels of a joint.
    distance : {'Euclidean', 'sum of absolute differences'}
        Over the three channels of a joint.
    threshold : float
        A joint is correct if its distance is below this.
    unit : str
        Unit of the threshold.
    source : str
        Source of these choices.
    """

    name: str
    representation: Representation
    distance: Literal["Euclidean", "sum of absolute differences"]
    threshold: float
    unit: str
    source: str

    def description(self) -> dict[str, str]:
        """Return the settings in words, for a footnote."""
        return {
            "representation": _WORDS[self.representation],
            "distance": f"{self.distance} over a joint's channels",
            "threshold": f"{self.threshold:g} {self.unit}".rstrip(),
            "source": self.source,
        }


DIFFSHEG: Final = CorrectSettings(
    name="diffsheg",
    representation="normalised rotations",
    distance="Euclidean",
    threshold=0.5,
    unit="",
    source="Chen et al. 2024, released evaluation",
)

BEAT: Final = CorrectSettings(
    name="beat",
    representation="euler angles",
    distance="sum of absolute differences",
    threshold=4.0,
    unit="°",
    source="Liu et al. 2022, released evaluation",
)

AMUSE: Final = CorrectSettings(
    name="amuse",
    representation="positions",
    distance="Euclidean",
    threshold=0.1,
    unit="m",
    source="Chhatre et al. 2024, appendix E; the threshold is not stated there and is EMAGE's",
)


def correct_joints(generated: Floats, recorded: Floats, settings: CorrectSettings) -> Bools:
    """Return which joints are correct, shape (T, J), of motions of shape (T, J, 3).

    Differences of Euler angles are wrapped to ±180°.
    """
    difference = generated - recorded
    if settings.representation == "euler angles":
        difference = (difference + 180) % 360 - 180
    if settings.distance == "Euclidean":
        distance = np.linalg.norm(difference, axis=2)
    else:
        distance = np.abs(difference).sum(axis=2)
    return np.asarray(distance < settings.threshold)


def correct_share(
    generated: Floats, recorded: Floats, weights: Floats | None = None, *, settings: CorrectSettings
) -> MetricResult:
    """Return the share of joints and frames whose motion is correct (PCM).

    Weighted by how meaningful each frame's gesture is, it is the semantic-relevant gesture recall
    (SRGR).

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, J, 3)
        In the representation of `settings`, at one frame rate.
    weights : ndarray, shape (T,), optional
        Semantic score of each frame, at least 0; as long as the longer clip.
    settings : CorrectSettings
        Usually one of the presets.

    Returns
    -------
    MetricResult
        In [0, 1], 1 for the recording itself. NaN if the clips cannot be paired or have no joint,
        or if no frame has a weight.
    """
    name = "percent of correct motion" if weights is None else "semantic-relevant gesture recall"
    metric = Metric(f"{name} ({settings.name})", better="higher")
    description = settings.description()
    generated, recorded, reason = paired(generated, recorded)
    frames, joints = generated.shape[:2]
    used = np.ones(frames) if weights is None else weights[:frames]
    if weights is not None:
        description["weights"] = "semantic scores, divided by their sum"
    if not reason and not joints:
        reason = "no joint moves in the recordings"
    if not reason and not used.sum() > 0:
        reason = "no frame has a semantic score above 0"
    if reason:
        return metric.missing(reason, description)
    wrong = 1 - correct_joints(generated, recorded, settings).mean(axis=1)
    value = max(0.0, 1 - float(wrong @ used / used.sum()))  # rounding never leaves [0, 1]
    return metric.score(value, int(np.count_nonzero(used)) * joints, description)
