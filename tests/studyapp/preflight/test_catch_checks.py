"""Whether a flaw can be seen is measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.skeleton import joint_index
from studyapp.preflight.catch_checks import catch_motion_findings, difference, pictures_of, unlike
from tests.support.encoded import Told, write_video
from tests.support.studies.made_study import make_study

FRAMES = 40


def swing(radians: float, shake: float = 0.0) -> MotionClip:
    """Return arms that swing so far, and shake."""
    poses = np.zeros((FRAMES, 55, 3))
    moments = np.linspace(0, 2 * np.pi, FRAMES)
    for side in ("left", "right"):
        poses[:, joint_index(f"{side}_shoulder"), 2] = radians * np.sin(moments)
    poses += np.random.default_rng(1).normal(0, shake, poses.shape)
    still = np.zeros((FRAMES, 3), np.float32)
    return MotionClip(poses=poses.astype(np.float32), trans=still, frame_rate=20)


def found(flawed: MotionClip, **changes: object) -> Mapping[str, str]:
    study = make_study(**changes)
    clips = {
        "rule_based": {"one": swing(0.4)},
        "mismatched": {"one": swing(-0.4)},
        "broken": {"one": flawed},
    }
    return {each.name: each.what for each in catch_motion_findings(study, clips)}


def test_clips_of_other_rates_and_lengths_are_compared_as_far_as_both_last() -> None:
    short = replace(swing(0.5), poses=swing(0.5).poses[:20], trans=np.zeros((20, 3), np.float32))

    assert difference(swing(0.5), short).metres == 0.0
    assert difference(swing(0.5), replace(swing(0.5), frame_rate=40)).metres > 0.01


def turned() -> MotionClip:
    """Return the right motion of a body that stands the other way."""
    moved = swing(0.4)
    poses = np.array(moved.poses)
    poses[:, joint_index("pelvis"), 1] = 2.0
    return replace(moved, poses=poses)


PLAIN, HARDLY = {"catch-difference"}, {"catch-difference", "catch-hardly-differs"}


@pytest.mark.parametrize(
    ("flawed", "changes", "names"),
    [
        (swing(0.41), {}, HARDLY),
        (swing(0.41), {"catch": {"trials": 0}}, set()),
        (swing(2.5), {}, PLAIN),
        (swing(0.4, shake=0.05), {}, PLAIN),
        (turned(), {}, PLAIN),
        (turned(), {"freeze": ["root"]}, HARDLY),
    ],
)
def test_a_flaw_shows_in_place_or_in_roughness_unless_it_is_frozen(
    flawed: MotionClip, changes: dict[str, object], names: set[str]
) -> None:
    said = found(flawed, **changes)

    assert set(said) == names
    hardly = "'broken' and 'rule_based' hardly differ in 1 of 1 segments: in one"
    assert hardly in said.get("catch-hardly-differs", hardly)


def test_pictures_of_one_video_are_like_each_other_and_unlike_anothers(tmp_path: Path) -> None:
    for name, frames in (("one", 30), ("other", 24)):
        write_video(tmp_path / f"{name}.mp4", Told(frames=frames))
    write_video(tmp_path / "slow.mp4", Told(frames=30, rate=10))
    one, other, slow = (pictures_of(tmp_path / f"{n}.mp4") for n in ("one", "other", "slow"))

    assert one is not None and other is not None and slow is not None
    assert unlike(one, other) == pytest.approx(0, abs=1.0)
    assert unlike(one, slow) > 5
    (tmp_path / "no.mp4").write_bytes(b"no video")
    assert pictures_of(tmp_path / "no.mp4") is None
