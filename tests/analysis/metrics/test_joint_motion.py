from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from analysis.metrics.joint_motion import common_frame_rate, joint_motion
from motion.clip import MotionClip
from motion.skeleton import REST_JOINTS, joint_index


def test_positions_do_not_see_where_the_body_walks_or_how_it_is_shaped(
    waving: Callable[..., MotionClip],
) -> None:
    still, walking = waving(), waving(drift=0.5)
    shaped = replace(still, betas=np.ones(10, np.float32))
    reference = joint_motion(still, 30.0).relative
    assert reference.shape == (120, 55, 3)
    np.testing.assert_allclose(reference[0], REST_JOINTS - REST_JOINTS[0], atol=1e-7)
    np.testing.assert_allclose(joint_motion(walking, 30.0).relative, reference, atol=1e-9)
    np.testing.assert_allclose(joint_motion(shaped, 30.0).relative, reference, atol=1e-9)


def test_a_slower_rate_gives_fewer_frames_of_the_same_motion(
    waving: Callable[..., MotionClip],
) -> None:
    clip = waving(frequency=0.5)
    slow = joint_motion(clip, 15.0).relative
    fast = joint_motion(clip, 30.0).relative
    assert len(slow) == 60
    np.testing.assert_allclose(slow, fast[::2], atol=2e-3)


def test_the_pelvis_walks_and_stands_as_high_as_its_feet_reach_down(
    waving: Callable[..., MotionClip],
) -> None:
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


def test_clips_are_compared_at_the_slowest_rate_up_to_thirty() -> None:
    assert common_frame_rate({60.0, 120.0}) == 30.0
    assert common_frame_rate([25.0, 60.0]) == 25.0
