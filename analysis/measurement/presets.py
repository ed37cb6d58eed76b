"""Named presets: the metrics of a paper, computed as in that paper.

Distances in features need a trained network; a preset lists its paper's networks, so that a report
can name the missing ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import chain
from types import MappingProxyType
from typing import Any, Final

from analysis.evaluators import feature_networks
from analysis.metrics import beat_alignment, correct_motion
from analysis.metrics.beat_alignment import BeatSettings
from analysis.metrics.correct_motion import CorrectSettings
from analysis.metrics.kinematics import (
    GENEA,
    GENEA_ACCELERATION,
    HANDS,
    HANDS_UNFILTERED,
    DerivativeSettings,
)
from analysis.metrics.point_errors import (
    MACE_LANDMARKS,
    MACE_POSES,
    MAJE,
    MALE,
    Norm,
    PointSettings,
)


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Metrics to compute, with their settings.

    Attributes
    ----------
    beats : tuple of BeatSettings
        Beat alignments; they need speech.
    derivatives : tuple of DerivativeSettings
        Jerks and accelerations.
    mean_pose_deviation, pair_distance, expression_distance : bool
        Diversity within clips, between clips, and between their faces.
    foot_sliding : bool
        Sliding of the feet.
    correct : tuple of CorrectSettings
        Percents of correct motion, and semantic-relevant gesture recalls if there are semantic
        scores. These and all the following need recorded motion.
    joint_errors, landmark_errors : tuple of PointSettings
        Errors of joints, and of face landmarks, in a box of one metre.
    velocity_errors : tuple of {'L1', 'L2'}
        Velocity errors.
    networks : tuple of str
        Feature networks (`analysis.evaluators.feature_networks`) whose scores the paper reports.
    """

    beats: tuple[BeatSettings, ...] = ()
    derivatives: tuple[DerivativeSettings, ...] = ()
    mean_pose_deviation: bool = False
    pair_distance: bool = False
    expression_distance: bool = False
    foot_sliding: bool = False
    correct: tuple[CorrectSettings, ...] = ()
    joint_errors: tuple[PointSettings, ...] = ()
    landmark_errors: tuple[PointSettings, ...] = ()
    velocity_errors: tuple[Norm, ...] = ()
    networks: tuple[str, ...] = ()

    @property
    def needs_recorded_spread(self) -> bool:
        """Whether all recordings must be measured before the first clip."""
        return bool(self.joint_errors or self.landmark_errors) or any(
            settings.representation == "normalised rotations" for settings in self.correct
        )

    @property
    def needs_rotations(self) -> bool:
        """Whether rotations are measured besides positions."""
        return self.needs_recorded_spread or any(
            settings.representation != "positions" for settings in self.correct
        )

    def without_recordings(self) -> Preset:
        """Return the part that can be measured without recorded motion."""
        return replace(self, correct=(), joint_errors=(), landmark_errors=(), velocity_errors=())


REPORT: Final = "report"

PRESETS: Final[Mapping[str, Preset]] = MappingProxyType(
    {
        REPORT: Preset(
            beats=(beat_alignment.AMUSE, beat_alignment.BEAT),
            derivatives=(HANDS, HANDS_UNFILTERED),
            mean_pose_deviation=True,
            pair_distance=True,
        ),
        "amuse": Preset(
            beats=(beat_alignment.AMUSE,),
            derivatives=(HANDS_UNFILTERED,),
            correct=(correct_motion.AMUSE,),
            networks=(feature_networks.EMOTION,),
        ),
        "beat": Preset(
            beats=(beat_alignment.BEAT,),
            mean_pose_deviation=True,
            correct=(correct_motion.BEAT,),
            networks=(feature_networks.GESTURE,),
        ),
        "diffsheg": Preset(
            beats=(beat_alignment.BEAT,),
            pair_distance=True,
            expression_distance=True,
            correct=(correct_motion.DIFFSHEG,),
            networks=(
                feature_networks.WHOLE,
                feature_networks.EXPRESSION,
                feature_networks.GESTURE,
            ),
        ),
        "genea": Preset(
            derivatives=(GENEA, GENEA_ACCELERATION), networks=(feature_networks.GESTURE,)
        ),
        "s2ue": Preset(
            joint_errors=(MAJE, MACE_POSES),
            landmark_errors=(MALE, MACE_LANDMARKS),
            networks=(feature_networks.LANDMARKS, feature_networks.GESTURE),
        ),
        "physical": Preset(
            derivatives=(HANDS, HANDS_UNFILTERED), foot_sliding=True, velocity_errors=("L1", "L2")
        ),
    }
)
"""Presets by name; 'report' is shown in every report, 'physical' follows no paper."""


def combined(names: Iterable[str]) -> Preset:
    """Return a preset with the metrics of all named presets, each once."""
    chosen = [PRESETS[name] for name in names]
    return Preset(**{part.name: _together(part.name, chosen) for part in fields(Preset)})


def _together(part: str, presets: Sequence[Preset]) -> Any:
    """Return the values of a field in all presets, each setting once."""
    values = [getattr(preset, part) for preset in presets]
    if isinstance(getattr(Preset, part), bool):
        return any(values)
    return tuple(dict.fromkeys(chain.from_iterable(values)))
