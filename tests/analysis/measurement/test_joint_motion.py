from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.measurement.joint_motion import joint_motion
from analysis.measurement.recorded_spread import ClipExtent, recorded_spread
from analysis.metrics.joint_positions import select
from motion.clip import MotionClip
from motion.freeze import freeze
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index


def test_positions_do_not_see_where_the_body_walks_or_how_it_is_shaped(waving):
    still, walking = waving(), waving(drift=0.5)
    shaped = replace(still, betas=np.ones(10, np.float32))
    reference = joint_motion(still, 30.0).relative
    assert reference.shape == (120, 55, 3)
    np.testing.assert_allclose(joint_motion(walking, 30.0).relative, reference, atol=1e-9)
    np.testing.assert_allclose(joint_motion(shaped, 30.0).relative, reference, atol=1e-9)


def test_a_slower_rate_gives_fewer_frames_of_the_same_motion(waving):
    clip = waving(frequency=0.5)
    slow = joint_motion(clip, 15.0).relative
    fast = joint_motion(clip, 30.0).relative
    assert len(slow) == 60
    np.testing.assert_allclose(slow, fast[::2], atol=2e-3)


def test_what_the_videos_hold_still_is_still_here(waving):
    clip = waving()
    poses = clip.poses.copy()
    poses[:, 0, 1] = np.linspace(0, 2, len(clip))
    turning = replace(clip, poses=poses)
    frozen = select(joint_motion(freeze(turning, ("root",)), 30.0).relative, ["head"])
    assert np.ptp(frozen, axis=0).max() == pytest.approx(0, abs=1e-6)


def test_positions_are_relative_to_the_pelvis():
    clip = MotionClip(poses=np.zeros((3, 55, 3)), trans=np.ones((3, 3)), frame_rate=30)
    positions = joint_motion(clip, 30).relative
    assert not positions[:, 0].any()
    np.testing.assert_allclose(positions[0], REST_JOINTS - REST_JOINTS[0], atol=1e-7)


def test_the_pelvis_walks_and_stands_as_high_as_its_feet_reach_down(waving):
    clip = waving(drift=0.5)
    pelvis = joint_motion(clip, 30.0).pelvis
    assert np.diff(pelvis[:, 0]) * 30 == pytest.approx(0.5, abs=1e-4)
    poses = clip.poses.copy()
    for side in ("left", "right"):
        poses[:, joint_index(f"{side}_hip"), 0] = -0.8
        poses[:, joint_index(f"{side}_knee"), 0] = 1.6
        poses[:, joint_index(f"{side}_ankle"), 0] = -0.8
    crouching = joint_motion(replace(clip, poses=poses), 30.0).pelvis
    assert crouching[0, 1] < pelvis[0, 1] - 0.1


def clips():
    chance = np.random.default_rng(0)
    for frames in (30, 50):
        rotations = chance.normal(0.4, 0.2, (frames, 3, 3))
        rotations[:, 1] = 0.7
        rotations[:, 2, 0] = -0.1
        yield rotations, chance.normal(0, 1, (frames, 5, 3))


def test_the_spread_of_clips_is_that_of_all_frames_together():
    found = recorded_spread(ClipExtent.of(*clip) for clip in clips())
    rotations = np.concatenate([rotations for rotations, _ in clips()])
    positions = np.concatenate([positions.reshape(-1, 3) for _, positions in clips()])
    np.testing.assert_allclose(found.mean, rotations.mean(axis=0))
    np.testing.assert_allclose(found.deviation[0], rotations[:, 0].std(axis=0))
    assert found.recordings == 2
    assert np.linalg.norm(np.ptp(positions, axis=0)) * found.scale == pytest.approx(1)


def test_joints_that_never_move_are_left_out_and_still_channels_stay_radians():
    found = recorded_spread(ClipExtent.of(*clip) for clip in clips())
    assert found.moving.tolist() == [True, False, True]
    assert found.deviation[2, 0] == 1
    rotations = np.concatenate([rotations for rotations, _ in clips()])
    standard = found.normalised(rotations)
    assert standard.shape == (80, 2, 3)
    np.testing.assert_allclose(standard[:, 0].std(axis=0), 1)
    assert np.abs(standard[:, 1, 0]).max() < 1e-9


def test_no_recording_and_no_extent_are_no_spread():
    assert recorded_spread([]) is None
    point = ClipExtent.of(np.zeros((4, 2, 3)), np.ones((4, 2, 3)))
    assert recorded_spread([point]) is None
