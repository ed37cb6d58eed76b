import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.metrics.kinematics import (
    CONTACT_HEIGHT,
    GENEA_ACCELERATION,
    HANDS,
    HANDS_UNFILTERED,
    foot_sliding,
    joint_motion,
    mean_derivative,
)
from motion.arrays import Floats
from motion.skeleton import REST_JOINTS, joint_index
from tests.analysis.waving import waving


def along_x(curve: Floats) -> Floats:
    positions = np.zeros((len(curve), 1, 3))
    positions[:, 0, 0] = curve
    return positions


@pytest.mark.parametrize("frame_rate", [24, 30, 60, 120])
def test_a_cubic_has_the_same_jerk_at_every_frame_rate(
    closed_form: Mapping[str, Any], frame_rate: float
) -> None:
    expected = closed_form["jerk"]
    time = np.arange(2 * frame_rate) / frame_rate
    found = mean_derivative(
        along_x(expected["c"] * time**3), frame_rate=frame_rate, settings=HANDS_UNFILTERED
    )
    assert found.value == pytest.approx(expected["value"], rel=1e-6)


def test_the_filter_keeps_gestures_and_removes_jitter() -> None:
    time = np.arange(600) / 30
    gesture = along_x(0.2 * np.sin(2 * np.pi * 1.0 * time))
    jitter = gesture + np.random.default_rng(0).normal(0, 0.002, gesture.shape)
    (clean, filtered), (unfiltered_gesture, unfiltered) = (
        [mean_derivative(each, frame_rate=30.0, settings=own).value for each in (gesture, jitter)]
        for own in (HANDS, HANDS_UNFILTERED)
    )
    assert clean == pytest.approx(unfiltered_gesture, rel=0.05)
    assert filtered < 0.4 * unfiltered


def test_a_steady_acceleration_is_found() -> None:
    falling = along_x(0.5 * 3.0 * (np.arange(20) / 25) ** 2)
    found = mean_derivative(falling, frame_rate=25.0, settings=GENEA_ACCELERATION)
    assert found.value == pytest.approx(3.0)
    assert found.unit == "m/s²"


def feet(
    frames: int = 60, *, speed: float = 0.0, frame_rate: float = 30.0, lifted: float = 0.0
) -> Floats:
    """Return two feet, side by side, of which the second is lifted and both glide along z."""
    positions = np.zeros((frames, 2, 3))
    positions[:, 0, 0] = 0.2
    positions[:, :, 2] = speed * np.arange(frames)[:, None] / frame_rate
    positions[:, 1, 1] = lifted
    return positions


@pytest.mark.parametrize("frame_rate", [15.0, 60.0])
def test_sliding_equals_the_speed_of_feet_on_the_ground(frame_rate: float) -> None:
    found = foot_sliding(feet(speed=0.4, frame_rate=frame_rate), frame_rate=frame_rate)
    assert found.value == pytest.approx(0.4)
    assert found.unit == "m/s"
    assert foot_sliding(feet(), frame_rate=frame_rate).value == 0


def test_sliding_fades_with_the_height_of_the_foot() -> None:
    found = foot_sliding(feet(speed=0.4, lifted=0.1), frame_rate=30)
    assert found.n == 59
    assert found.value == pytest.approx(0.4)
    walking = feet(lifted=0.1)
    walking[:, 1, 2] = np.linspace(0, 2, 60)
    assert foot_sliding(walking, frame_rate=30).value == 0
    half = foot_sliding(feet(speed=0.4, lifted=CONTACT_HEIGHT / 2), frame_rate=30)
    assert half.value == pytest.approx(0.4 * (1 + 2 - math.sqrt(2)) / 2)


def test_clips_too_short_too_slow_or_without_a_standing_foot_have_a_reason_for_no_score() -> None:
    clip, flying = np.zeros((40, 2, 3)), feet()
    flying[::2, :, 1] = 1.0
    for result, reason in (
        (mean_derivative(clip[:15], frame_rate=30.0, settings=HANDS), "fewer than 16 frames"),
        (mean_derivative(clip, frame_rate=10.0, settings=HANDS), "10 fps is too slow"),
        (
            mean_derivative(clip[:2], frame_rate=25.0, settings=GENEA_ACCELERATION),
            "fewer than 3 frames",
        ),
        (foot_sliding(flying, frame_rate=30), "no foot stays"),
        (foot_sliding(feet(1), frame_rate=30), "a speed needs two frames"),
    ):
        assert math.isnan(result.value)
        assert reason in result.reason


def test_joint_positions_ignore_walking_and_body_shape() -> None:
    still, walking = waving(), waving(drift=0.5)
    shaped = replace(still, betas=np.ones(10, np.float32))
    reference = joint_motion(still, 30.0).relative
    assert reference.shape == (120, 55, 3)
    np.testing.assert_allclose(reference[0], REST_JOINTS - REST_JOINTS[0], atol=1e-7)
    np.testing.assert_allclose(joint_motion(walking, 30.0).relative, reference, atol=1e-9)
    np.testing.assert_allclose(joint_motion(shaped, 30.0).relative, reference, atol=1e-9)


def test_a_lower_rate_gives_fewer_frames_of_the_same_motion() -> None:
    clip = waving(frequency=0.5)
    slow = joint_motion(clip, 15.0).relative
    fast = joint_motion(clip, 30.0).relative
    assert len(slow) == 60
    np.testing.assert_allclose(slow, fast[::2], atol=2e-3)


def test_the_pelvis_follows_walking_and_crouching() -> None:
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
