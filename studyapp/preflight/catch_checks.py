"""Whether the flawed motion of catch trials differs visibly from the motion beside it.

Participants who fail these trials count as inattentive, so the two must differ plainly: in the
positions of the joints or in how jerkily they move. Ordinary pairs of the same study are the
yardstick.
"""

from collections.abc import Iterator, Mapping
from itertools import combinations
from statistics import median
from typing import Final

import numpy as np

from motion.arrays import Floats
from motion.clip import MotionClip, freeze
from motion.resample import resample
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from studyapp.preflight.finding import Finding, make_finding
from studyapp.study.settings.study import Study

LEAST_CM: Final = 2.0
"""Mean distance of joints below which nobody can be expected to see a difference."""

LEAST_SHARE: Final = 0.5
"""Of the usual difference between conditions, below which a difference does not stand out."""

JERKY: Final = 3.0
"""Ratio of accelerations from which motion looks broken, wherever its joints are."""

_UPPER: Final = (
    *("neck", "head", "left_shoulder", "left_elbow", "left_wrist"),
    *("right_shoulder", "right_elbow", "right_wrist"),
)
_LOWER: Final = ("left_knee", "left_ankle", "right_knee", "right_ankle")
_FRAMED_JOINTS: Final = {
    "upper_body": _UPPER,
    "full_body": (*_UPPER, *_LOWER),
    "face": ("neck", "head"),
    "hands": ("left_elbow", "left_wrist", "right_elbow", "right_wrist"),
}
"""Joints that are compared, by the study's framing."""


def motion_difference(
    first: MotionClip, second: MotionClip, framing: str = "upper_body"
) -> tuple[float, float]:
    """Return how much two motions differ in the visible joints, up to the end of the shorter.

    Returns
    -------
    metres : float
        Mean distance between the same joints at the same time.
    acceleration_ratio : float
        Mean acceleration of the second motion relative to the first; infinite if only the second
        moves.
    """
    rate = min(first.frame_rate, second.frame_rate)
    joints = [joint_index(name) for name in _FRAMED_JOINTS[framing]]
    one, other = (
        forward_kinematics(clip.poses, clip.trans, REST_JOINTS)[0][:, joints]
        for clip in (resample(first, rate), resample(second, rate))
    )
    frames = min(len(one), len(other))
    reference, flawed = (_mean_acceleration(positions, rate) for positions in (one, other))
    metres = float(np.linalg.norm(one[:frames] - other[:frames], axis=2).mean())
    return metres, flawed / reference if reference else (np.inf if flawed else 1.0)


def _mean_acceleration(positions: Floats, rate: float) -> float:
    """Return the mean acceleration in m/s²; 0 for fewer than three frames."""
    if len(positions) < 3:
        return 0.0
    return float(np.linalg.norm(np.diff(positions, n=2, axis=0), axis=2).mean() * rate**2)


def catch_motion_findings(
    study: Study, clips: Mapping[str, Mapping[str, MotionClip]]
) -> Iterator[Finding]:
    """Yield how much the motions of catch trials differ, and where they hardly do.

    Parameters
    ----------
    clips : mapping of str to mapping of str to MotionClip
        The available motion, by condition and segment.
    """
    flawed, reference, framing = study.catch.condition, study.catch_against, study.video.framing
    centimetres: dict[str, float] = {}
    usual: list[float] = []
    jerky: set[str] = set()
    for segment in clips.get(reference, {}) if study.catch.trials else ():
        if segment not in clips.get(flawed, {}):
            continue
        shown = {
            name: freeze(by_segment[segment], study.freeze)
            for name, by_segment in clips.items()
            if segment in by_segment
        }
        metres, ratio = motion_difference(shown[reference], shown[flawed], framing)
        centimetres[segment] = 100 * metres
        if ratio >= JERKY:
            jerky.add(segment)
        usual += [
            100 * motion_difference(shown[a], shown[b], framing)[0]
            for a, b in combinations([name for name in shown if name in study.conditions], 2)
        ]
    if not centimetres:
        return
    clause = "the mean distance of joints is {:.1f} cm"
    typical = median(usual) if usual else 0.0
    comparison = f"; in other pairs, {clause.format(typical)}" if usual else ""
    yield make_finding(
        "catch-difference",
        f"in catch trials, {clause.format(median(centimetres.values()))}{comparison} (median over "
        "segments)",
    )
    similar = {
        segment: difference
        for segment, difference in centimetres.items()
        if difference < max(LEAST_CM, LEAST_SHARE * typical) and segment not in jerky
    }
    if similar:
        worst = min(similar, key=similar.__getitem__)
        yield make_finding(
            "catch-hardly-differs",
            f"{flawed!r} and {reference!r} hardly differ in {len(similar)} of {len(centimetres)} "
            f"segments: in {worst}, {clause.format(similar[worst])}{comparison}",
        )
