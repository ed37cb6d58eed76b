from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.evaluators.published_presets import (
    MEAN_DIRECTIONS,
    beat_frames,
    talkshow_frames,
    ted_frames,
    ted_joints,
)
from motion.arrays import Floats
from motion.clip import MotionClip
from motion.formats.smplx_rows import read_rows
from motion.skeleton import FINGERS, RELAXED_HANDS, joint_index
from tests.motion.random_clips import clip_of
from training.spaces.beat import UPPER_BODY_JOINTS, beat_clip, upper_body_motion
from training.spaces.smplx_bodies import rotation_rows


def _clip(poses: NDArray[np.floating]) -> MotionClip:
    return clip_of(poses.reshape(len(poses), 55, 3))


def test_emage_gets_the_first_two_rows_of_each_joints_rotation_matrix(reference: Path) -> None:
    with np.load(reference / "emage_plain.npz") as expected:
        for poses, seen in zip(expected["axis_angle"], expected["motion"], strict=True):
            np.testing.assert_allclose(rotation_rows(_clip(poses)), seen, atol=1e-6)


def test_ted_gets_unit_directions_of_the_published_joints_minus_the_published_mean(
    reference: Path,
) -> None:
    with np.load(reference / "ted_plain.npz") as expected:
        np.testing.assert_array_equal(expected["mean_dir_vec"], MEAN_DIRECTIONS)
    random = np.random.default_rng(0)
    seen = ted_frames(_clip(random.normal(0, 0.2, (4, 55, 3))))
    lengths = np.linalg.norm((seen + MEAN_DIRECTIONS).reshape(4, 9, 3), axis=2)
    np.testing.assert_allclose(lengths, 1)


def test_the_left_hand_stays_the_left_hand_for_ted() -> None:
    poses = np.zeros((1, 55, 3))
    poses[0, joint_index("left_shoulder"), 2] = 0.5
    still, moved = ted_joints(_clip(np.zeros((1, 55, 3))))[0], ted_joints(_clip(poses))[0]
    assert np.flatnonzero(np.linalg.norm(moved - still, axis=1) > 0.01).tolist() == [5, 6]
    assert moved[6, 1] < still[6, 1] and moved[6, 0] < 0  # y is down, x to the person's right


def test_talkshow_gets_the_columns_that_its_code_picks(tmp_path: Path) -> None:
    row = np.linspace(0.001, 0.265, 265)[None]
    np.save(tmp_path / "talk.npy", row)
    clip = read_rows(tmp_path / "talk.npy")
    poses = clip.poses.copy()
    poses[:, FINGERS] += RELAXED_HANDS
    left_out = [*range(18), *range(21, 27), *range(30, 36), *range(45, 51)]
    picked = np.delete(row[:, :165], left_out, axis=1)
    np.testing.assert_allclose(talkshow_frames(_clip(poses)), picked, atol=1e-6)


def test_beats_angles_survive_a_round_trip_through_a_clip() -> None:
    turns = np.random.default_rng(0).normal(0, 0.2, (12, 47, 3))
    roots = [
        p for p, name in enumerate(UPPER_BODY_JOINTS) if name.endswith(("Ring", "Pinky", "Index"))
    ]
    forearms = [p for p, name in enumerate(UPPER_BODY_JOINTS) if name.endswith(("ForeArm", "Hand"))]
    turns[:, roots + forearms] = 0
    values = np.concatenate([turns.reshape(12, -1), np.zeros((12, 51))], axis=1)
    given = upper_body_motion(values[:, :141], 15.0)
    columns = [given.columns(given.joint_names.index(name)) for name in UPPER_BODY_JOINTS]
    wanted = np.stack([given.values[:, c.stop - 3 : c.stop] for c in columns], axis=1)
    found = beat_frames(beat_clip(values, 15.0)).reshape(12, 47, 3)
    assert np.isnan(found[:, roots]).all()
    kept = np.setdiff1d(np.arange(47), roots + forearms)
    np.testing.assert_allclose(found[:, kept], wanted[:, kept], atol=0.01)
    # Elbow and wrist share the little twist by which the two figures differ at rest.
    np.testing.assert_allclose(found[:, forearms], wanted[:, forearms], atol=3)


@pytest.mark.parametrize("frames", [rotation_rows, beat_frames, ted_frames, talkshow_frames])
def test_no_network_depends_on_the_bodys_position(frames: Callable[[MotionClip], Floats]) -> None:
    clip = _clip(np.random.default_rng(0).normal(0, 0.2, (3, 55, 3)))
    moved = clip_of(clip.poses, clip.trans + 2)
    np.testing.assert_allclose(frames(clip), frames(moved), atol=1e-9)
