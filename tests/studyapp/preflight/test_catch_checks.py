"""Invisible flaws of catch trials are found."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.skeleton import joint_index
from studyapp.preflight.catch_checks import catch_motion_findings, motion_difference
from tests.motion.random_clips import clip_of
from tests.support.studies.made_study import make_study

FRAMES = 40


def swing(radians: float, shake: float = 0.0) -> MotionClip:
    """Return arms that swing by `radians` and shake."""
    poses = np.zeros((FRAMES, 55, 3))
    moments = np.linspace(0, 2 * np.pi, FRAMES)
    for side in ("left", "right"):
        poses[:, joint_index(f"{side}_shoulder"), 2] = radians * np.sin(moments)
    poses += np.random.default_rng(1).normal(0, shake, poses.shape)
    return clip_of(poses, frame_rate=20)


def check(flawed: MotionClip, **changes: object) -> Mapping[str, str]:
    study = make_study(**changes)
    clips = {
        "rule_based": {"one": swing(0.4)},
        "mismatched": {"one": swing(-0.4)},
        "broken": {"one": flawed},
    }
    return {finding.name: finding.what for finding in catch_motion_findings(study, clips)}


def test_clips_of_different_rates_and_lengths_are_compared_up_to_the_shorter_end() -> None:
    short = replace(swing(0.5), poses=swing(0.5).poses[:20], trans=np.zeros((20, 3), np.float32))

    assert motion_difference(swing(0.5), short)[0] == 0.0
    assert motion_difference(swing(0.5), replace(swing(0.5), frame_rate=40))[0] > 0.01


def turned_around() -> MotionClip:
    """Return the reference motion of a body that faces away."""
    clip = swing(0.4)
    poses = np.array(clip.poses)
    poses[:, joint_index("pelvis"), 1] = 2.0
    return replace(clip, poses=poses)


PLAIN, SIMILAR = {"catch-difference"}, {"catch-difference", "catch-hardly-differs"}


@pytest.mark.parametrize(
    ("flawed", "changes", "names"),
    [
        (swing(0.41), {}, SIMILAR),
        (swing(0.41), {"catch": {"trials": 0}}, set()),
        (swing(2.5), {}, PLAIN),
        (swing(0.4, shake=0.05), {}, PLAIN),
        (turned_around(), {}, PLAIN),
        (turned_around(), {"freeze": ["root"]}, SIMILAR),
    ],
)
def test_a_flaw_shows_in_positions_or_accelerations_unless_it_is_frozen(
    flawed: MotionClip, changes: dict[str, object], names: set[str]
) -> None:
    findings = check(flawed, **changes)

    assert set(findings) == names
    similar = "'broken' and 'rule_based' hardly differ in 1 of 1 segments: in one"
    assert similar in findings.get("catch-hardly-differs", similar)
