"""How well clips follow their own speech, compared with another take's.

A clip that does not depend on its speech follows another's as well as its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.beat_alignment import AMUSE, BeatSettings, beat_alignment
from analysis.metrics.kinematics import ARM_JOINTS, WRISTS, joint_motion, select
from analysis.stats.samples import bootstrap_counts, percentile_interval
from motion.audio_analysis import DETECTOR
from motion.clip import ARKIT_NAMES, MotionClip
from tools.corpus_page.measuring import correlate_curves
from training.corpus.truth import mean_speed

FloatArray = NDArray[np.float64]

RESAMPLES: Final = 10_000
BEATS: Final[BeatSettings] = AMUSE
JAW: Final = ARKIT_NAMES.index("jawOpen")
EDGE: Final = 1.0
"""Seconds at both ends that do not count: all takes begin and end silent and at rest, where each
would follow any other."""
_FEWEST: Final = 1.0
"""Seconds; correlations over less are due to chance."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Speech:
    """The truth about a take's speech.

    Attributes
    ----------
    wrist_speed, jaw_open : ndarray, shape (T,)
        The process' own curves without noise, at the clips' frame rate.
    onsets : ndarray, shape (N,)
        Onsets of sounds, in seconds.
    strokes : ndarray, shape (M,)
        Arrival times of the process' strokes, in seconds.
    """

    wrist_speed: FloatArray
    jaw_open: FloatArray
    onsets: FloatArray
    strokes: FloatArray

    def __len__(self) -> int:
        return len(self.wrist_speed)


@dataclass(frozen=True, kw_only=True)
class Followed:
    """How well one clip follows a speech; NaN where undefined.

    Attributes
    ----------
    wrist_speed, jaw_open : float
        Pearson's correlation of the clip's curve with the process' own.
    beats : float
        Beat alignment (AMUSE's) minus chance.
    strokes : float
        The same, with the process' strokes in place of the onsets of sounds.
    """

    wrist_speed: float
    jaw_open: float
    beats: float
    strokes: float


MEASURES: Final = ("wrist_speed", "jaw_open", "beats", "strokes")


def follow(clip: MotionClip, speech: Speech) -> Followed:
    """Return how well `clip` follows `speech` while both last, without `EDGE` at either end."""
    rate = clip.frame_rate
    edge = round(EDGE * rate)
    inside = slice(edge, min(len(clip), len(speech)) - edge)
    if inside.stop - inside.start < _FEWEST * rate:
        return Followed(wrist_speed=np.nan, jaw_open=np.nan, beats=np.nan, strokes=np.nan)
    positions = joint_motion(clip, rate).relative
    arms = select(positions[inside], ARM_JOINTS)
    jaw = np.zeros(len(clip)) if clip.arkit is None else clip.arkit[:, JAW].astype(np.float64)

    def aligned(times: FloatArray, detector: str) -> float:
        heard = times[(times >= EDGE) & (times < inside.stop / rate)] - EDGE
        return beat_alignment(
            arms,
            heard,
            speech_duration=len(arms) / rate,
            frame_rate=rate,
            settings=BEATS,
            detector=detector,
        ).above_chance.value

    return Followed(
        wrist_speed=correlate_curves(
            mean_speed(select(positions, WRISTS), rate)[inside], speech.wrist_speed[inside]
        ),
        jaw_open=correlate_curves(jaw[inside], speech.jaw_open[inside]),
        beats=aligned(speech.onsets, DETECTOR),
        strokes=aligned(speech.strokes, "the process' strokes"),
    )


@dataclass(frozen=True, kw_only=True)
class MeanFollowed:
    """A mean over clips with its 95% interval.

    Attributes
    ----------
    mean, low, high : float
        NaN where no clip has a value.
    clips : int
        Clips with a value.
    """

    mean: float
    low: float
    high: float
    clips: int


def mean_followed(
    scores: Mapping[str, Followed], groups: Mapping[str, str], measure: str
) -> MeanFollowed:
    """Return the mean over takes, with an interval from resampling whole groups.

    Parameters
    ----------
    scores : mapping of take to Followed
        Scores of one condition.
    groups : mapping of take to str
        Takes of one text by one speaker resemble each other and are drawn together.
    measure : str
        One of `MEASURES`.
    """
    finite = {take: getattr(score, measure) for take, score in sorted(scores.items())}
    finite = {take: value for take, value in finite.items() if np.isfinite(value)}
    if not finite:
        return MeanFollowed(mean=np.nan, low=np.nan, high=np.nan, clips=0)
    values = np.array(list(finite.values()))
    group = np.unique([groups[take] for take in finite], return_inverse=True)[1]
    sums, counts = np.bincount(group, weights=values), np.bincount(group)
    times = bootstrap_counts(np.random.default_rng(0), RESAMPLES, len(counts))
    low, high = percentile_interval(times @ sums / (times @ counts))
    return MeanFollowed(mean=float(values.mean()), low=low, high=high, clips=len(finite))
