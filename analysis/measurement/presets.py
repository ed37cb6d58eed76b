"""Named presets: which metrics a paper reports, each computed as that paper computed it.

Distances in the features of a network need one that the researcher has trained; a preset says which
networks its paper uses, so that a report names those that are missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, TypeVar

from analysis.evaluators import network_names
from analysis.metrics import beat_alignment, correct_motion
from analysis.metrics.absolute_error import MAJE, MALE, PointSettings
from analysis.metrics.acceleration_error import MACE_LANDMARKS, MACE_POSES
from analysis.metrics.beat_alignment import BeatSettings
from analysis.metrics.correct_motion import CorrectSettings
from analysis.metrics.jerk import GENEA, HANDS, HANDS_UNFILTERED, JerkSettings
from analysis.metrics.velocity_error import Norm
from motion.errors import InputError

_Settings = TypeVar("_Settings")


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Metrics to compute, with their settings.

    Attributes
    ----------
    beats : tuple of BeatSettings
        Beat alignments; they need speech.
    jerks : tuple of JerkSettings
        Jerks.
    acceleration : bool
        Acceleration.
    mean_pose_deviation, pair_distance, expression_distance : bool
        Diversity within clips, between clips, and between their faces.
    foot_sliding : bool
        Sliding of the feet.
    correct : tuple of CorrectSettings
        Percents of correct motion; they need recorded motion, as do all that follow.
    recalls : tuple of CorrectSettings
        Semantic-relevant gesture recalls; they need semantic scores too.
    absolute_errors, acceleration_errors : tuple of PointSettings
        Errors of joints in a box of one metre.
    landmark_errors, landmark_accelerations : tuple of PointSettings
        The same of face landmarks.
    velocity_errors : tuple of {'L1', 'L2'}
        Velocity errors.
    speed_histogram : bool
        Distance of speed histograms.
    networks : tuple of str
        Feature networks (`analysis.evaluators.network_names`) whose scores the paper reports.
    """

    beats: tuple[BeatSettings, ...] = ()
    jerks: tuple[JerkSettings, ...] = ()
    acceleration: bool = False
    mean_pose_deviation: bool = False
    pair_distance: bool = False
    expression_distance: bool = False
    foot_sliding: bool = False
    correct: tuple[CorrectSettings, ...] = ()
    recalls: tuple[CorrectSettings, ...] = ()
    absolute_errors: tuple[PointSettings, ...] = ()
    acceleration_errors: tuple[PointSettings, ...] = ()
    landmark_errors: tuple[PointSettings, ...] = ()
    landmark_accelerations: tuple[PointSettings, ...] = ()
    velocity_errors: tuple[Norm, ...] = ()
    speed_histogram: bool = False
    networks: tuple[str, ...] = ()

    @property
    def needs_recorded_spread(self) -> bool:
        """Whether all recordings must be looked at before the first clip is measured."""
        errors = (self.absolute_errors, self.acceleration_errors)
        return (
            any(errors)
            or self.needs_landmarks
            or any(
                settings.representation == "normalised rotations"
                for settings in (*self.correct, *self.recalls)
            )
        )

    @property
    def needs_rotations(self) -> bool:
        """Whether rotations are measured besides positions."""
        return self.needs_recorded_spread or any(
            settings.representation != "positions" for settings in (*self.correct, *self.recalls)
        )

    @property
    def needs_landmarks(self) -> bool:
        """Whether face landmarks are measured."""
        return bool(self.landmark_errors or self.landmark_accelerations)

    @property
    def needs_clips(self) -> bool:
        """Whether anything but joint positions is measured, so that files must be read."""
        return self.needs_rotations or self.needs_landmarks or self.expression_distance

    def without_recordings(self) -> Preset:
        """Return what of this can be measured without recorded motion."""
        return replace(
            self,
            correct=(),
            recalls=(),
            absolute_errors=(),
            acceleration_errors=(),
            landmark_errors=(),
            landmark_accelerations=(),
            velocity_errors=(),
            speed_histogram=False,
        )


REPORT: Final = "report"

PRESETS: Final[Mapping[str, Preset]] = MappingProxyType(
    {
        REPORT: Preset(
            beats=beat_alignment.PRESETS,
            jerks=(HANDS, HANDS_UNFILTERED),
            mean_pose_deviation=True,
            pair_distance=True,
        ),
        "amuse": Preset(
            beats=(beat_alignment.AMUSE,),
            jerks=(HANDS_UNFILTERED,),
            correct=(correct_motion.AMUSE,),
            recalls=(correct_motion.AMUSE,),
            networks=(network_names.EMOTION,),
        ),
        "beat": Preset(
            beats=(beat_alignment.BEAT,),
            mean_pose_deviation=True,
            correct=(correct_motion.BEAT,),
            recalls=(correct_motion.BEAT,),
            networks=(network_names.GESTURE,),
        ),
        "diffsheg": Preset(
            beats=(beat_alignment.BEAT,),
            pair_distance=True,
            expression_distance=True,
            correct=(correct_motion.DIFFSHEG,),
            recalls=(correct_motion.DIFFSHEG,),
            networks=(network_names.WHOLE, network_names.EXPRESSION, network_names.GESTURE),
        ),
        "genea": Preset(
            jerks=(GENEA,),
            acceleration=True,
            speed_histogram=True,
            networks=(network_names.GESTURE,),
        ),
        "s2ue": Preset(
            absolute_errors=(MAJE,),
            acceleration_errors=(MACE_POSES,),
            landmark_errors=(MALE,),
            landmark_accelerations=(MACE_LANDMARKS,),
            networks=(network_names.LANDMARKS, network_names.GESTURE),
        ),
        "talkshow": Preset(beats=(beat_alignment.TALKSHOW,)),
        "physical": Preset(
            jerks=(HANDS, HANDS_UNFILTERED), foot_sliding=True, velocity_errors=("L1", "L2")
        ),
    }
)
"""By name; 'report' is what every report shows, 'physical' what asks for no paper."""


def combined(names: Iterable[str]) -> Preset:
    """Return one preset with the metrics of all that are named, each once.

    Raises
    ------
    InputError
        If a name is unknown.
    """
    together = Preset()
    for name in names:
        if name not in PRESETS:
            raise InputError(
                f"unknown preset {name!r}", remedy=f"Use any of {', '.join(sorted(PRESETS))}"
            )
        together = _both(together, PRESETS[name])
    return together


def _both(one: Preset, other: Preset) -> Preset:
    return Preset(
        beats=_once(one.beats + other.beats),
        jerks=_once(one.jerks + other.jerks),
        acceleration=one.acceleration or other.acceleration,
        mean_pose_deviation=one.mean_pose_deviation or other.mean_pose_deviation,
        pair_distance=one.pair_distance or other.pair_distance,
        expression_distance=one.expression_distance or other.expression_distance,
        foot_sliding=one.foot_sliding or other.foot_sliding,
        correct=_once(one.correct + other.correct),
        recalls=_once(one.recalls + other.recalls),
        absolute_errors=_once(one.absolute_errors + other.absolute_errors),
        acceleration_errors=_once(one.acceleration_errors + other.acceleration_errors),
        landmark_errors=_once(one.landmark_errors + other.landmark_errors),
        landmark_accelerations=_once(one.landmark_accelerations + other.landmark_accelerations),
        velocity_errors=_once(one.velocity_errors + other.velocity_errors),
        speed_histogram=one.speed_histogram or other.speed_histogram,
        networks=_once(one.networks + other.networks),
    )


def _once(settings: tuple[_Settings, ...]) -> tuple[_Settings, ...]:
    return tuple(dict.fromkeys(settings))
