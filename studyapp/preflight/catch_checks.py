"""Whether the flawed motion of catch trials differs visibly from the motion beside it.

Participants who fail these trials count as inattentive, so the two must differ plainly: in the
positions of the joints or in how jerkily they move; for finished videos, in their pictures.
Ordinary pairs of the same study are the yardstick.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import combinations
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np

from motion.arrays import Floats, Floats32
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.resample import resample
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from renderer.figures.sheet import pictures_of
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.study.settings.study import Study

WIDTH: Final = 64
"""Pixels of downscaled pictures: grain and coding artefacts vanish, limbs stay."""

PICTURE_SECONDS: Final = 0.2
"""Between two compared pictures."""

MOST_SEGMENTS: Final = 6
"""Segments whose pictures are compared; decoding all would take long."""

LEAST_CM: Final = 2.0
"""Mean distance of joints below which nobody can be expected to see a difference."""

LEAST_GREY: Final = 0.1
"""Difference of grey levels below which pictures are the same but for coding artefacts."""

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


Pictures = Floats32
"""Downscaled grey pictures of a video, shape (N, H, W), 0 (black) to 255."""


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


def _picture_difference(first: Pictures, second: Pictures) -> float:
    """Return the mean grey difference of the pixels that differ most, up to the shorter's end.

    A limb covers a small part of a picture, so only the tenth of each picture's pixels that
    differs most is counted.
    """
    count = min(len(first), len(second))
    if count == 0 or first.shape[1:] != second.shape[1:]:
        return 255.0
    differences = np.abs(first[:count] - second[:count]).reshape(count, -1)
    pixels = max(1, differences.shape[1] // 10)
    return float(np.partition(differences, -pixels, axis=1)[:, -pixels:].mean())


def _read_pictures(video: Path) -> Pictures | None:
    """Return downscaled pictures of a video; None if it cannot be decoded."""
    pictures: list[Pictures] = []
    with suppress(InputError), pictures_of(video) as stream:
        height = max(2, round(WIDTH * stream.height / stream.width / 2) * 2)
        for frame in stream.container.decode(stream):
            if frame.time is None or frame.time + 1e-6 < len(pictures) * PICTURE_SECONDS:
                continue
            grey = frame.reformat(width=WIDTH, height=height, format="gray")
            pictures.append(grey.to_ndarray().astype(np.float32))
        return np.stack(pictures)
    return None


def catch_motion_findings(
    study: Study, clips: Mapping[str, Mapping[str, MotionClip]]
) -> Iterator[Finding]:
    """Yield how much the motions of catch trials differ, and where they hardly do.

    Parameters
    ----------
    clips : mapping of str to mapping of str to MotionClip
        The available motion, by condition and segment.
    """
    flawed, reference = study.catch.condition, study.catch_against
    if not study.catch.trials:
        return
    centimetres: dict[str, float] = {}
    usual: list[float] = []
    jerky: set[str] = set()
    for segment in clips.get(reference, {}):
        if segment not in clips.get(flawed, {}):
            continue
        shown = {
            name: freeze(by_segment[segment], study.freeze)
            for name, by_segment in clips.items()
            if segment in by_segment
        }
        framing = study.video.framing
        metres, ratio = motion_difference(shown[reference], shown[flawed], framing)
        centimetres[segment] = 100 * metres
        if ratio >= JERKY:
            jerky.add(segment)
        usual += [
            100 * motion_difference(shown[a], shown[b], framing)[0]
            for a, b in combinations([name for name in shown if name in study.conditions], 2)
        ]
    yield from _difference_findings(
        study, centimetres, usual, "the mean distance of joints is {:.1f} cm", LEAST_CM, jerky
    )


def catch_picture_findings(material: Material) -> Iterator[Finding]:
    """Yield the same for finished videos, from their pictures."""
    study = material.study
    flawed, reference = study.catch.condition, study.catch_against
    if not study.catch.trials or not study.is_finished(flawed):
        return
    files = {
        (content[0].condition, content[0].segment): file
        for file, content in material.finished.items()
        if file.is_file()
    }
    grey_levels: dict[str, float] = {}
    usual: list[float] = []
    for segment in list(material.segments_by_name)[:MOST_SEGMENTS]:
        shown = {
            name: pictures
            for name in dict.fromkeys((*study.conditions, flawed))
            if (name, segment) in files
            and (pictures := _read_pictures(files[name, segment])) is not None
        }
        if flawed in shown and reference in shown:
            grey_levels[segment] = _picture_difference(shown[flawed], shown[reference])
        ordinary = [pictures for name, pictures in shown.items() if name in study.conditions]
        usual += [_picture_difference(a, b) for a, b in combinations(ordinary, 2)]
    yield from _difference_findings(
        study, grey_levels, usual, "the pictures differ by {:.1f} of 255 grey levels", LEAST_GREY
    )


def _difference_findings(
    study: Study,
    caught: Mapping[str, float],
    usual: Sequence[float],
    clause: str,
    least: float,
    jerky: Collection[str] = (),
) -> Iterator[Finding]:
    """Compare the differences of catch trials, by segment, with those of ordinary pairs.

    Parameters
    ----------
    clause : str
        States a difference, with braces for its number.
    least : float
        Difference below which nobody can be expected to see it.
    jerky : collection of str
        Segments whose flaw is plain, however small the difference.
    """
    if not caught:
        return
    typical = median(usual) if usual else 0.0
    comparison = f"; in other pairs, {clause.format(typical)}" if usual else ""
    yield make_finding(
        "catch-difference",
        f"in catch trials, {clause.format(median(caught.values()))}{comparison} (median over "
        "segments)",
    )
    similar = {
        segment: difference
        for segment, difference in caught.items()
        if difference < max(least, LEAST_SHARE * typical) and segment not in jerky
    }
    if similar:
        worst = min(similar, key=similar.__getitem__)
        yield make_finding(
            "catch-hardly-differs",
            f"{study.catch.condition!r} and {study.catch_against!r} hardly differ in "
            f"{len(similar)} of {len(caught)} segments: in {worst}, "
            f"{clause.format(similar[worst])}{comparison}",
        )
