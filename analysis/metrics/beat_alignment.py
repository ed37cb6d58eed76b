"""Beat alignment: whether a motion stops and turns where the speech has its beats.

The literature gives one name to different scores, so each preset fixes all choices. Because a
wide Gaussian rewards any dense beats (onsets unrelated to the motion easily score .8), every
score comes with its chance level, and the difference is what to compare.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d
from scipy.signal import find_peaks

from analysis.metrics.joint_positions import ARM_JOINTS
from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]
Direction = Literal["motion to audio", "audio to motion"]

SHIFTS: Final = 200
"""Circular shifts over which the chance level is averaged."""

SHALLOWEST: Final = 0.01
"""Metres per second by which a motion beat must lie below its surroundings."""


@dataclass(frozen=True, kw_only=True)
class BeatSettings:
    """What makes a beat alignment score comparable with another.

    Attributes
    ----------
    name : str
        Names the preset.
    direction : {'motion to audio', 'audio to motion'}
        Each beat of the first kind is scored by its distance to the nearest of the second.
    joints : tuple of str
        The joints whose speed is looked at.
    pooling : {'mean speed', 'each joint'}
        One series of motion beats from the joints' mean speed, or one per joint with the mean of
        their scores.
    sigma : float
        Width of the Gaussian in seconds.
    window : float
        A motion beat is slower than everything within this many seconds before and after it.
    source : str
        Where the choices come from.
    """

    name: str
    direction: Direction
    joints: tuple[str, ...]
    pooling: Literal["mean speed", "each joint"]
    sigma: float
    window: float
    source: str

    def described(self, frame_rate: float, detector: str) -> dict[str, str]:
        """Return the settings in words, for a footnote."""
        return {
            "direction": self.direction,
            "joints": ", ".join(self.joints),
            "pooling": self.pooling,
            "sigma": f"{self.sigma:g} s",
            "extremum window": f"{self.window:.3g} s on each side "
            f"({extremum_order(self.window, frame_rate)} frames)",
            "least dip": f"{SHALLOWEST:g} m/s",
            "frame rate": f"{frame_rate:g} fps",
            "onsets": detector,
            "chance": f"mean over {SHIFTS} circular shifts of the motion beats",
            "source": self.source,
        }


AMUSE: Final = BeatSettings(
    name="amuse",
    direction="motion to audio",
    joints=ARM_JOINTS,
    pooling="mean speed",
    sigma=0.1,
    window=7 / 30,
    source="Chhatre et al. 2024, appendix E (direction, joints); sigma and window are ours",
)
"""AMUSE's text: from each motion beat of the arms to the nearest audio beat."""

BEAT: Final = BeatSettings(
    name="beat",
    direction="audio to motion",
    joints=ARM_JOINTS,
    pooling="each joint",
    sigma=0.3,
    window=7 / 30,
    source="Liu et al. 2022 (BEAT), direction, joints and sigma; its speed threshold is not used",
)
"""BEAT's evaluation: from each audio onset to the nearest motion beat of each joint."""

PRESETS: Final = (AMUSE, BEAT)


@dataclass(frozen=True, kw_only=True)
class BeatAlignment:
    """The scores of one clip.

    Attributes
    ----------
    score : MetricResult
        Beat alignment in [0, 1].
    chance : MetricResult
        What the same beats score when the motion is shifted in time.
    above_chance : MetricResult
        `score` minus `chance`: 0 means that the motion ignores the speech.
    motion_beats : MetricResult
        Motion beats per second (mean over joints where each joint has its own).
    """

    score: MetricResult
    chance: MetricResult
    above_chance: MetricResult
    motion_beats: MetricResult


def extremum_order(window: float, frame_rate: float) -> int:
    """Return how many frames on each side a motion beat must be slower than; at least 1."""
    return max(1, round(window * frame_rate))


def motion_beats(speed: FloatArray, frame_rate: float, window: float) -> FloatArray:
    """Return when a speed curve has its local minima.

    Parameters
    ----------
    speed : ndarray, shape (T,)
        Speed in m/s between frames k and k + 1, so that value k belongs to time
        (k + ½) / frame_rate.
    frame_rate : float
        Frames per second.
    window : float
        Seconds on each side over which no value may be smaller.

    Returns
    -------
    ndarray, shape (N,)
        Times in seconds, ascending; the middle of a stretch of equal minima. A dip of less than
        `SHALLOWEST` is rounding or sensor noise and no beat.
    """
    order = extremum_order(window, frame_rate)
    dips, shape = find_peaks(-speed, prominence=SHALLOWEST, plateau_size=1, distance=order + 1)
    lowest = minimum_filter1d(speed, 2 * order + 1, mode="nearest")
    is_lowest = speed[dips] <= lowest[dips]
    middles = (shape["left_edges"] + shape["right_edges"]) / 2
    return np.asarray((middles[is_lowest] + 0.5) / frame_rate, np.float64)


def alignment_score(queries: FloatArray, targets: FloatArray, sigma: float) -> float:
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
    motion: FloatArray,
    audio: FloatArray,
    duration: float,
    sigma: float,
    direction: Direction,
) -> float:
    """Return the mean score over motion beats shifted circularly within the clip.

    The shifts are evenly spaced, so that the level is the same at every call; the unshifted
    motion is not among them.
    """
    shifts = duration * (np.arange(SHIFTS) + 0.5) / SHIFTS
    return float(
        np.mean([_directed((motion + s) % duration, audio, sigma, direction) for s in shifts])
    )


def beat_alignment(
    positions: FloatArray,
    onsets: FloatArray,
    *,
    frame_rate: float,
    settings: BeatSettings,
    detector: str,
) -> BeatAlignment:
    """Score one clip against the onsets of its speech.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of `settings.joints` in metres.
    onsets : ndarray, shape (N,)
        Onsets of the speech in seconds from the clip's start.
    frame_rate : float
        Frames per second of `positions`.
    settings : BeatSettings
        Usually one of `PRESETS`.
    detector : str
        What found `onsets`, for the settings of the result.

    Returns
    -------
    BeatAlignment
        NaN with a reason where the motion or the speech has no beat.
    """
    duration = len(positions) / frame_rate
    speeds = np.linalg.norm(np.diff(positions, axis=0), axis=2).T * frame_rate
    if settings.pooling == "mean speed":
        speeds = speeds.mean(axis=0, keepdims=True)
    series = [motion_beats(speed, frame_rate, settings.window) for speed in speeds]
    moving = [beats for beats in series if len(beats)]
    described = settings.described(frame_rate, detector)
    reason = "" if moving else "the motion has no beat"
    reason = reason if len(onsets) else "the speech has no onset"
    score = chance = math.nan
    if not reason:
        sigma, direction = settings.sigma, settings.direction
        score = float(np.mean([_directed(b, onsets, sigma, direction) for b in moving]))
        chance = float(
            np.mean([chance_score(b, onsets, duration, sigma, direction) for b in moving])
        )
    rate = sum(len(beats) for beats in series) / len(series) / duration
    to_audio = settings.direction == "motion to audio"
    scored = sum(len(beats) for beats in moving) if to_audio else len(onsets) * len(moving)

    def result(name: str, value: float) -> MetricResult:
        return MetricResult(
            name=f"{name} ({settings.name})",
            value=value,
            unit="",
            n=0 if reason else scored,
            settings=described,
            reason=reason,
        )

    return BeatAlignment(
        score=result("beat alignment", score),
        chance=result("beat alignment by chance", chance),
        above_chance=result("beat alignment above chance", score - chance),
        motion_beats=MetricResult(
            name=f"motion beat rate ({settings.name})",
            value=rate,
            unit="1/s",
            n=len(series),
            settings=described,
        ),
    )


def _directed(motion: FloatArray, audio: FloatArray, sigma: float, direction: Direction) -> float:
    if direction == "motion to audio":
        return alignment_score(motion, audio, sigma)
    return alignment_score(audio, motion, sigma)
