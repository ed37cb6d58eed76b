from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.metrics.joint_positions import common_frame_rate, joint_positions, select
from motion.clip import MotionClip
from motion.rest_pose import REST_JOINTS


def test_clips_are_compared_at_the_slowest_rate_up_to_thirty():
    assert common_frame_rate({15.0, 30.0}) == 15.0
    assert common_frame_rate({60.0, 120.0}) == 30.0
    assert common_frame_rate([25.0]) == 25.0


def test_positions_do_not_see_where_the_body_walks_or_how_it_is_shaped(waving):
    still, walking = waving(), waving(drift=0.5)
    shaped = replace(still, betas=np.ones(10, np.float32))
    reference = joint_positions(still, 30.0)
    assert reference.shape == (120, 55, 3)
    np.testing.assert_allclose(joint_positions(walking, 30.0), reference, atol=1e-9)
    np.testing.assert_allclose(joint_positions(shaped, 30.0), reference, atol=1e-9)


def test_a_slower_rate_gives_fewer_frames_of_the_same_motion(waving):
    clip = waving(frequency=0.5)
    slow = joint_positions(clip, 15.0)
    fast = joint_positions(clip, 30.0)
    assert len(slow) == 60
    np.testing.assert_allclose(slow, fast[::2], atol=2e-3)


def test_what_the_videos_hold_still_is_still_here(waving):
    clip = waving()
    poses = clip.poses.copy()
    poses[:, 0, 1] = np.linspace(0, 2, len(clip))
    turning = replace(clip, poses=poses)
    frozen = select(joint_positions(turning, 30.0, ("root",)), ["head"])
    assert np.ptp(frozen, axis=0).max() == pytest.approx(0, abs=1e-6)


def test_joints_are_selected_by_name_in_the_order_asked(waving):
    positions = joint_positions(waving(), 30.0)
    left, right = (select(positions, [name])[:, 0] for name in ("left_wrist", "right_wrist"))
    both = select(positions, ["right_wrist", "left_wrist"])
    np.testing.assert_array_equal(both[:, 0], right)
    np.testing.assert_array_equal(both[:, 1], left)
    assert left[0, 0] > 0 > right[0, 0]


def test_positions_are_relative_to_the_pelvis():
    clip = MotionClip(poses=np.zeros((3, 55, 3)), trans=np.ones((3, 3)), frame_rate=30)
    positions = joint_positions(clip, 30)
    assert not positions[:, 0].any()
    np.testing.assert_allclose(positions[0], REST_JOINTS - REST_JOINTS[0], atol=1e-9)
