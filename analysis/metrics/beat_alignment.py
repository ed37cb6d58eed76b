"""Beat alignment: whether a motion stops where the speech has its beats.

Papers use one name for different scores, so each preset fixes all choices. A wide Gaussian rewards
any dense beats: onsets unrelated to the motion easily score .8. So every score has a chance level;
compare the differences from it.
"""

import math
from dataclasses import dataclass, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from scipy.ndimage import minimum_filter1d
from scipy.signal import find_peaks

from analysis.metrics.kinematics import ARM_JOINTS
from analysis.metrics.point_errors import LEAST_OVERLAP
from analysis.metrics.scores import Better, Metric, MetricResult
from motion.arrays import Floats

Direction = Literal["motion to audio", "audio to motion"]

SHIFTS: Final = 200
"""Circular shifts over which the chance level is averaged."""

SHALLOWEST: Final = 0.01
"""Metres per second by which a motion beat is slower than its surroundings; a shallower dip is
rounding or sensor noise."""

WINDOW: Final = 7 / 30
"""A motion beat is slower than everything within this many seconds before and after it."""


@dataclass(frozen=True, kw_only=True)
class BeatSettings:
    """The choices that define a beat alignment score.

    Attributes
    ----------
    name : str
        Name of the preset.
    direction : {'motion to audio', 'audio to motion'}
        Each beat of the first kind is scored by its distance to the nearest of the second.
    pooling : {'mean speed', 'each joint'}
        One series of motion beats from the mean speed of the joints, or one series per joint, whose
        scores are averaged.
    sigma : float
        Width of the Gaussian in seconds.
    source : str
        Source of these choices.
    """

    name: str
    direction: Direction
    pooling: Literal["mean speed", "each joint"]
    sigma: float
    source: str

    def description(self, frame_rate: float, detector: str) -> dict[str, str]:
        """Return the settings in words, for a footnote."""
        return {
            "direction": self.direction,
            "joints": ", ".join(ARM_JOINTS),
            "motion": "speed of joints, m/s",
            "pooling": self.pooling,
            "sigma": f"{self.sigma:g} s",
            "extremum window": f"{WINDOW:.3g} s on each side ({extremum_order(frame_rate)} frames)",
            "least dip": f"{SHALLOWEST:g} m/s",
            "frame rate": f"{frame_rate:g} fps",
            "onsets": detector,
            "chance": f"mean over {SHIFTS} circular shifts of the motion beats",
            "source": self.source,
        }


AMUSE: Final = BeatSettings(
    name="amuse",
    direction="motion to audio",
    pooling="mean speed",
    sigma=0.1,
    source="Chhatre et al. 2024, appendix E (direction, joints); sigma and window are ours",
)
"""AMUSE's text: from each motion beat of the arms to the nearest audio beat."""

BEAT: Final = BeatSettings(
    name="beat",
    direction="audio to motion",
    pooling="each joint",
    sigma=0.3,
    source="Liu et al. 2022 (BEAT), direction, joints and sigma; its speed threshold is not used",
)
"""BEAT's evaluation: from each audio onset to the nearest motion beat of each joint."""


class BeatAlignment(NamedTuple):
    """The scores of one clip.

    Attributes
    ----------
    above_chance : MetricResult
        `score` minus `chance`: 0 means that the motion ignores the speech.
    score : MetricResult
        Beat alignment in [0, 1].
    opposite : MetricResult
        The score of the same beats in the other direction: a motion that stops at every onset and
        at many other times scores high in one direction only.
    chance : MetricResult
        The score of the same beats when the motion is shifted in time.
    motion_beats : MetricResult
        Motion beats per second (mean over joints where each joint has its own).
    """

    above_chance: MetricResult
    score: MetricResult
    opposite: MetricResult
    chance: MetricResult
    motion_beats: MetricResult


def extremum_order(frame_rate: float) -> int:
    """Return the window in frames on each side of a motion beat, at least 1."""
    return max(1, round(WINDOW * frame_rate))


def motion_beats(speed: Floats, frame_rate: float) -> Floats:
    """Return the times of the local minima of a speed curve.

    Parameters
    ----------
    speed : ndarray, shape (T,)
        Metres per second between frames k and k + 1, so that value k belongs to time
        (k + ½) / frame_rate.
    frame_rate : float
        Frames per second.

    Returns
    -------
    ndarray, shape (N,)
        Times in seconds, ascending; the middle of a stretch of equal minima.
    """
    order = extremum_order(frame_rate)
    dips, shape = find_peaks(-speed, prominence=SHALLOWEST, plateau_size=1, distance=order + 1)
    lowest = minimum_filter1d(speed, 2 * order + 1, mode="nearest")
    is_lowest = speed[dips] <= lowest[dips]
    middles = (shape["left_edges"] + shape["right_edges"]) / 2
    return np.asarray((middles[is_lowest] + 0.5) / frame_rate, np.float64)


def alignment_score(queries: Floats, targets: Floats, sigma: float) -> float:
    """Return the mean Gaussian closeness of each query to its nearest target.

    Parameters
    ----------
    queries, targets : ndarray, shape (N,), (M,)
        Times in seconds, in any order.
    sigma : float
        Width of the Gaussian in seconds.

    Returns
    -------
    float
        In [0, 1]; NaN without queries or targets.
    """
    if not len(queries) or not len(targets):
        return math.nan
    distance = np.abs(np.subtract.outer(queries, targets)).min(axis=1)
    return float(np.exp(-(distance**2) / (2 * sigma**2)).mean())


def chance_score(
    motion: Floats, audio: Floats, duration: float, sigma: float, direction: Direction
) -> float:
    """Return the mean score over motion beats shifted circularly within the clip.

    The shifts are evenly spaced, so the level is reproducible; the unshifted motion is not among
    them.
    """
    scores = []
    for shift in duration * (np.arange(SHIFTS) + 0.5) / SHIFTS:
        shifted = (motion + shift) % duration
        queries, targets = (shifted, audio) if direction == "motion to audio" else (audio, shifted)
        scores.append(alignment_score(queries, targets, sigma))
    return float(np.mean(scores))


def beat_alignment(
    positions: Floats,
    onsets: Floats,
    *,
    speech_duration: float,
    frame_rate: float,
    settings: BeatSettings,
    detector: str,
) -> BeatAlignment:
    """Score one clip against the onsets of its speech.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of the arms' joints in metres.
    onsets : ndarray, shape (N,)
        Onsets of the speech in seconds from the clip's start.
    speech_duration : float
        Seconds.
    frame_rate : float
        Frames per second of `positions`.
    settings : BeatSettings
        Usually `AMUSE` or `BEAT`.
    detector : str
        The onset detector, for the settings of the result.

    Returns
    -------
    BeatAlignment
        NaN with a reason if the motion or the speech has no beat, or if one is much shorter.
    """
    duration = len(positions) / frame_rate
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=2).T * frame_rate
    if settings.pooling == "mean speed":
        speeds = speeds.mean(axis=0, keepdims=True)
    series = [motion_beats(speed, frame_rate) for speed in speeds]
    moving = [beats for beats in series if len(beats)]
    description = settings.description(frame_rate, detector)
    reason = "" if moving else "the motion has no beat"
    reason = reason if len(onsets) else "the speech has no onset"
    if min(duration, speech_duration) < LEAST_OVERLAP * max(duration, speech_duration):
        reason = f"the clip lasts {duration:.2f} s and its speech {speech_duration:.2f} s"
    to_audio, sigma = settings.direction == "motion to audio", settings.sigma
    opposite_direction = "audio to motion" if to_audio else "motion to audio"
    pairs = [(beats, onsets) if to_audio else (onsets, beats) for beats in moving]
    score = back = chance = math.nan
    if not reason:
        score = float(np.mean([alignment_score(start, end, sigma) for start, end in pairs]))
        back = float(np.mean([alignment_score(end, start, sigma) for start, end in pairs]))
        chances = (chance_score(b, onsets, duration, sigma, settings.direction) for b in moving)
        chance = float(np.mean([*chances]))
    n = sum(len(start) for start, _ in pairs)

    def result(name: str, value: float, better: Better = "higher") -> MetricResult:
        metric = Metric(f"{name} ({settings.name})", better=better)
        return (
            metric.missing(reason, description) if reason else metric.score(value, n, description)
        )

    rate = sum(len(beats) for beats in series) / len(series) / duration
    return BeatAlignment(
        above_chance=result("beat alignment above chance", score - chance),
        score=result("beat alignment", score),
        opposite=replace(
            result("beat alignment", back),
            name=f"beat alignment ({settings.name}, {opposite_direction})",
            n=0 if reason else sum(len(end) for _, end in pairs),
            settings=description | {"direction": opposite_direction},
        ),
        chance=result("beat alignment by chance", chance, "unsaid"),
        motion_beats=Metric(f"motion beat rate ({settings.name})", "1/s").score(
            rate, len(series), description
        ),
    )
