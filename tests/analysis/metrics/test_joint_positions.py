from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.metrics.joint_positions import ARM_JOINTS, common_frame_rate, joint_positions


def test_clips_are_compared_at_the_slowest_rate_up_to_thirty():
    assert common_frame_rate({15.0, 30.0}) == 15.0
    assert common_frame_rate({60.0, 120.0}) == 30.0
    assert common_frame_rate([25.0]) == 25.0


def test_positions_do_not_see_where_the_body_walks_or_how_it_is_shaped(waving):
    still, walking = waving(), waving(drift=0.5)
    shaped = replace(still, betas=np.ones(10, np.float32))
    reference = joint_positions(still, ARM_JOINTS, 30.0)
    assert reference.shape == (120, 6, 3)
    np.testing.assert_allclose(joint_positions(walking, ARM_JOINTS, 30.0), reference, atol=1e-9)
    np.testing.assert_allclose(joint_positions(shaped, ARM_JOINTS, 30.0), reference, atol=1e-9)


def test_a_slower_rate_gives_fewer_frames_of_the_same_motion(waving):
    clip = waving(frequency=0.5)
    slow = joint_positions(clip, ["left_wrist"], 15.0)
    fast = joint_positions(clip, ["left_wrist"], 30.0)
    assert len(slow) == 60
    np.testing.assert_allclose(slow, fast[::2], atol=2e-3)


def test_what_the_videos_hold_still_is_still_here(waving):
    clip = waving()
    poses = clip.poses.copy()
    poses[:, 0, 1] = np.linspace(0, 2, len(clip))
    turning = replace(clip, poses=poses)
    frozen = joint_positions(turning, ["head"], 30.0, ("root",))
    assert np.ptp(frozen, axis=0).max() == pytest.approx(0, abs=1e-6)
