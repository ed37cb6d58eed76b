from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from motion.clip import MotionClip
from motion.formats.bvh import read_bvh
from motion.formats.clip_bvh import write_clip_bvh
from motion.skeleton import JOINT_NAMES, REST_JOINTS, forward_kinematics
from tests.motion.random_clips import clip_of, clips


def assert_joints_found(path: Path, clip: MotionClip) -> None:
    written = read_bvh(path, frame_rate=clip.frame_rate)
    positions, _ = written.forward_kinematics()
    found = positions[:, [written.joint_names.index(name) for name in JOINT_NAMES]] / 100
    expected, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    np.testing.assert_allclose(found, expected, atol=1e-4)


@settings(max_examples=25)
@given(clips())
def test_every_joint_is_where_the_clip_puts_it(
    tmp_path_factory: pytest.TempPathFactory, clip: MotionClip
) -> None:
    path = tmp_path_factory.mktemp("bvh") / "a.bvh"
    write_clip_bvh(path, clip, REST_JOINTS)
    assert_joints_found(path, clip)


def test_turns_by_a_right_angle_are_told_without_a_warning(tmp_path: Path) -> None:
    poses = np.full((3, 55, 3), 0.2)
    poses[:, 16] = (np.pi / 2, 0, 0)
    clip = clip_of(poses)
    write_clip_bvh(tmp_path / "a.bvh", clip, REST_JOINTS)
    assert_joints_found(tmp_path / "a.bvh", clip)


def test_angles_do_not_jump_where_a_joint_goes_on_turning(tmp_path: Path) -> None:
    poses = np.zeros((60, 55, 3), np.float32)
    poses[:, 20, 2] = np.linspace(2, 6, 60)
    clip = clip_of(poses)
    write_clip_bvh(tmp_path / "a.bvh", clip, REST_JOINTS)
    assert np.abs(np.diff(read_bvh(tmp_path / "a.bvh").values, axis=0)).max() < 10
