from pathlib import Path

import numpy as np
import pybvh
import pytest
from hypothesis import example, given, settings

from motion.clip import MotionClip
from motion.formats.bvh import read_bvh
from motion.formats.bvh_motion import settle_first_frame, write_clip_bvh
from motion.skeleton import JOINT_NAMES, REST_JOINTS, forward_kinematics
from tests.motion.formats.bvh_text import CHAIN, columns_of, read_chain
from tests.motion.random_clips import clip_of, clips


def test_a_pose_left_over_in_the_first_frame_is_smoothed_out(tmp_path: Path) -> None:
    rows = np.stack([columns_of(CHAIN, {"knee": (0, 10 + k, 0)}) for k in range(4)])
    rows[0] += columns_of(CHAIN, {"hip": (20, 0, 0)})
    motion = settle_first_frame(read_chain(tmp_path, rows))
    rows[0] -= columns_of(CHAIN, {"hip": (20, 0, 0)})
    np.testing.assert_allclose(motion.values, rows)
    assert "1 joints" in motion.notes[0]


def _bending(**first: tuple[float, float, float]) -> np.ndarray:
    """Return four rows of a slowly bending leg; the first has the pose `first` instead."""
    rows = [columns_of(CHAIN, {"hip": (5, k, 0), "knee": (0, 10 + 5 * k, 0)}) for k in range(4)]
    return np.stack([columns_of(CHAIN, first), *rows[1:]])


def test_a_calibration_pose_in_the_first_row_is_removed_in_spite_of_a_later_glitch(
    tmp_path: Path,
) -> None:
    angles = 20 * np.sin(np.arange(90) / 9)
    rows = np.stack([columns_of(CHAIN, {"knee": (0, angle, 0)}) for angle in angles])
    rows[0] = columns_of(CHAIN, {"hip": (170, 0, 0), "knee": (0, 0, 90)})
    rows[50] = columns_of(CHAIN, {"hip": (170, 0, 0), "knee": (0, 90, 0)})
    motion = settle_first_frame(read_chain(tmp_path, rows))
    assert motion.calibration is not None
    np.testing.assert_allclose(motion.calibration, rows[0])
    np.testing.assert_allclose(motion.values, rows[[1, *range(1, 90)]])
    assert "first frame is not part of the motion" in motion.notes[0]


_JUMPING = _bending(hip=(170, 0, 0), knee=(0, 0, 90))
_JUMPING[3] = columns_of(CHAIN, {"hip": (-170, 0, 90), "knee": (0, 90, 0)})


@pytest.mark.parametrize(
    "rows", [_bending(hip=(80, 0, 0), knee=(0, 0, 60)), _JUMPING, *(_bending()[:n] for n in (1, 2))]
)
def test_quick_starts_and_frequent_jumps_are_not_mistaken_for_calibration(
    tmp_path: Path, rows: np.ndarray
) -> None:
    motion = read_chain(tmp_path, rows)
    assert settle_first_frame(motion) is motion


RIGHT_ANGLES = clip_of(np.tile([np.pi / 2, 0, 0], (3, 55, 1)))
"""At which Euler angles are ambiguous, of which scipy warns."""


@settings(max_examples=25)
@given(clips())
@example(RIGHT_ANGLES)
def test_another_reader_finds_every_joint_in_the_clips_position(
    tmp_path_factory: pytest.TempPathFactory, clip: MotionClip
) -> None:
    path = tmp_path_factory.mktemp("bvh") / "a.bvh"
    write_clip_bvh(path, clip, REST_JOINTS)
    assert read_bvh(path).frame_rate == pytest.approx(clip.frame_rate, rel=1e-6)
    written = pybvh.read_bvh_file(path, world_up="+y")
    places = [written.joint_names.index(name) for name in JOINT_NAMES]
    expected, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    np.testing.assert_allclose(written.joint_positions()[:, places] / 100, expected, atol=1e-4)


def test_angles_of_a_turning_joint_do_not_jump(tmp_path: Path) -> None:
    poses = np.zeros((60, 55, 3), np.float32)
    poses[:, 20, 2] = np.linspace(2, 6, 60)
    clip = clip_of(poses)
    write_clip_bvh(tmp_path / "a.bvh", clip, REST_JOINTS)
    assert np.abs(np.diff(read_bvh(tmp_path / "a.bvh").values, axis=0)).max() < 10
