"""Whether the flawed motion of catch trials can be told from the one it is shown beside: measured.

A participant who fails such a trial counts as inattentive. So the two must differ plainly: in
where the joints are, or in how roughly they move; of finished videos, in their pictures. Ordinary
pairs of the same study are the yardstick.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from statistics import median
from typing import Any, Final

import av
import numpy as np
from numpy.typing import NDArray

from motion.clip import MotionClip, freeze
from motion.resample import resample
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.study.settings.study import Study

WIDTH: Final = 64
"""Pixels to which pictures are made smaller: grain and the encoder's traces go, limbs stay."""

EVERY: Final = 0.2
"""Seconds between two pictures that are looked at."""


Pictures = NDArray[np.float32]
"""Small grey pictures of a video, 0 (black) to 255; of shape (N, H, W)."""


def unlike(one: Pictures, other: Pictures) -> float:
    """Return the mean difference of grey where most differs, as far as both videos last.

    A limb covers a small part of the picture: of each pair of pictures, the tenth of the pixels
    that differ most is counted.
    """
    both = min(len(one), len(other))
    if both == 0 or one.shape[1:] != other.shape[1:]:
        return 255.0
    apart = np.abs(one[:both] - other[:both]).reshape(both, -1)
    most = max(1, apart.shape[1] // 10)
    return float(np.partition(apart, -most, axis=1)[:, -most:].mean())


def pictures_of(video: Path) -> Pictures | None:
    """Return small pictures of a video; None where it cannot be decoded."""
    grey: list[NDArray[np.float32]] = []
    try:
        with av.open(str(video)) as container:
            if not container.streams.video:
                return None
            stream: Any = container.streams.video[0]
            height = max(2, round(WIDTH * stream.height / stream.width / 2) * 2)
            for frame in container.decode(stream):
                if frame.time is None or frame.time + 1e-6 < len(grey) * EVERY:
                    continue
                small = frame.reformat(width=WIDTH, height=height, format="gray")
                grey.append(small.to_ndarray().astype(np.float32))
    except (av.FFmpegError, OSError):
        return None
    return np.stack(grey) if grey else None


LEAST_METRES: Final = 0.02
"""Mean distance of joints below which nobody is expected to see a difference of position."""

LEAST_SHARE: Final = 0.5
"""Of what the conditions differ among each other, below which a difference does not stand out."""

ROUGHER: Final = 3.0
"""Times the acceleration from which motion looks broken wherever its joints are."""

MOST_SEGMENTS: Final = 6
"""Segments whose pictures are compared; to decode them all would take long."""

_UPPER: Final = (
    *("neck", "head", "left_shoulder", "left_elbow", "left_wrist"),
    *("right_shoulder", "right_elbow", "right_wrist"),
)
_LOWER: Final = ("left_knee", "left_ankle", "right_knee", "right_ankle")
_SEEN: Final = {
    "upper_body": _UPPER,
    "full_body": (*_UPPER, *_LOWER),
    "face": ("neck", "head"),
    "hands": ("left_elbow", "left_wrist", "right_elbow", "right_wrist"),
}
"""Joints by which motions are told apart, by the study's framing."""

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Difference:
    """How much two motions of one segment differ.

    Attributes
    ----------
    metres : float
        Mean distance of the same joint at the same moment.
    rougher : float
        Mean acceleration of the second by that of the first; infinite beside one that stands still.
    """

    metres: float
    rougher: float


def difference(one: MotionClip, other: MotionClip, framing: str = "upper_body") -> Difference:
    """Return how much two motions differ, as far as both last, in the joints that are seen."""
    rate = min(one.frame_rate, other.frame_rate)
    joints = [joint_index(name) for name in _SEEN[framing]]
    first, second = (_positions(resample(clip, rate))[:, joints] for clip in (one, other))
    both = min(len(first), len(second))
    still, moved = (_acceleration(positions, rate) for positions in (first, second))
    return Difference(
        metres=float(np.linalg.norm(first[:both] - second[:both], axis=2).mean()),
        rougher=moved / still if still > 0 else (np.inf if moved > 0 else 1.0),
    )


def catch_motion_findings(
    study: Study, clips: Mapping[str, Mapping[str, MotionClip]]
) -> Iterator[Finding]:
    """Say how much the motions of catch trials differ, and where they hardly do.

    Parameters
    ----------
    clips : mapping of str to mapping of str to MotionClip
        The motion that there is, by condition and segment.
    """
    flawed, right = clips.get(study.catch.condition, {}), clips.get(study.catch_against, {})
    if not study.catch.trials:
        return
    framing = study.video.framing
    caught: dict[str, Difference] = {}
    usual: list[float] = []
    for segment in [name for name in right if name in flawed]:
        shown = {
            name: freeze(made[segment], study.freeze)
            for name, made in clips.items()
            if segment in made
        }
        caught[segment] = difference(
            shown[study.catch_against], shown[study.catch.condition], framing
        )
        usual += [
            difference(shown[a], shown[b], framing).metres
            for a, b in combinations([name for name in shown if name in study.conditions], 2)
        ]
    if not caught:
        return
    between = median(usual) if usual else 0.0
    beside = f"; other pairs {_centimetres(between)}" if usual else ""
    yield finding(
        "catch-difference",
        f"in catch trials the joints lie {_centimetres(median(d.metres for d in caught.values()))} "
        f"apart{beside} (means over joints and time, of the middle segment)",
    )
    least = max(LEAST_METRES, LEAST_SHARE * between)
    hardly = {
        segment: found
        for segment, found in caught.items()
        if found.metres < least and found.rougher < ROUGHER
    }
    if hardly:
        worst = min(hardly, key=lambda segment: hardly[segment].metres)
        yield finding(
            "catch-hardly-differs",
            f"{study.catch.condition!r} and {study.catch_against!r} hardly differ in {len(hardly)} "
            f"of {len(caught)} segments: in {worst} the joints lie "
            f"{_centimetres(hardly[worst].metres)} apart{beside}",
        )


def catch_picture_findings(material: Material) -> Iterator[Finding]:
    """Say so of finished videos, whose motion is seen in their pictures alone."""
    study = material.study
    if not study.catch.trials or not study.is_finished(study.catch.condition):
        return
    files = {
        (content[0].condition, content[0].segment): file
        for file, content in material.brought.items()
        if file.is_file()
    }
    caught: dict[str, float] = {}
    usual: list[float] = []
    for segment in list(material.by_name)[:MOST_SEGMENTS]:
        shown: dict[str, Pictures] = {}
        for name in dict.fromkeys((*study.conditions, study.catch.condition)):
            pictures = pictures_of(files[name, segment]) if (name, segment) in files else None
            if pictures is not None:
                shown[name] = pictures
        if {study.catch.condition, study.catch_against} <= set(shown):
            pair = shown[study.catch.condition], shown[study.catch_against]
            caught[segment] = unlike(*pair)
        compared = [shown[name] for name in shown if name in study.conditions]
        usual += [unlike(a, b) for a, b in combinations(compared, 2)]
    if not caught:
        return
    between = median(usual) if usual else 0.0
    beside = f"; other pairs by {between:.1f}" if usual else ""
    yield finding(
        "catch-difference",
        f"in catch trials the pictures differ by {median(caught.values()):.1f} of 255 levels of "
        f"grey{beside} (of the middle segment)",
    )
    hardly = {name: found for name, found in caught.items() if found < LEAST_SHARE * between}
    hardly |= {name: found for name, found in caught.items() if found == 0}
    if hardly:
        worst = min(hardly, key=hardly.__getitem__)
        yield finding(
            "catch-hardly-differs",
            f"{study.catch.condition!r} and {study.catch_against!r} hardly differ in {len(hardly)} "
            f"of {len(caught)} segments: in {worst} their pictures differ by {hardly[worst]:.1f} "
            f"of 255 levels of grey{beside}",
            where=material.name_of(files[study.catch.condition, worst]),
        )


def _positions(clip: MotionClip) -> FloatArray:
    return forward_kinematics(clip.poses, clip.trans, REST_JOINTS)[0]


def _acceleration(positions: FloatArray, rate: float) -> float:
    """Return the mean acceleration in m/s²; 0 for fewer than three frames."""
    if len(positions) < 3:
        return 0.0
    return float(np.linalg.norm(np.diff(positions, n=2, axis=0), axis=2).mean() * rate**2)


def _centimetres(metres: float) -> str:
    return f"{100 * metres:.1f} cm"
