from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analysis.measurement.joint_motion import joint_motion
from analysis.metrics.derivatives import (
    CONTACT_HEIGHT,
    GENEA_ACCELERATION,
    HANDS,
    HANDS_UNFILTERED,
    foot_sliding,
    mean_derivative,
)
from analysis.metrics.joint_positions import common_frame_rate, select


def along_x(curve):
    positions = np.zeros((len(curve), 1, 3))
    positions[:, 0, 0] = curve
    return positions


@pytest.mark.parametrize("frame_rate", [24, 30, 60, 120])
def test_a_cubic_has_the_same_jerk_at_every_frame_rate(closed_form, frame_rate):
    expected = closed_form["jerk"]
    time = np.arange(2 * frame_rate) / frame_rate
    found = mean_derivative(
        along_x(expected["c"] * time**3), frame_rate=frame_rate, settings=HANDS_UNFILTERED
    )
    assert found.value == pytest.approx(expected["value"], rel=1e-6)


def test_a_sinusoid_agrees_with_its_closed_form(closed_form):
    expected = closed_form["jerk"]
    time = np.arange(600) / expected["fps"]
    curve = expected["A"] * np.sin(2 * np.pi * expected["f"] * time)
    found = mean_derivative(along_x(curve), frame_rate=expected["fps"], settings=HANDS_UNFILTERED)
    # The mean of |sin| is 2 / pi of the amplitude that the closed form gives.
    assert found.value == pytest.approx(expected["value_sin"] * 2 / math.pi, rel=1e-2)


def test_white_noise_is_amplified_as_its_binomial_sum_says():
    noise = np.random.default_rng(0).normal(0, 0.001, (4000, 1, 3))
    found = mean_derivative(noise, frame_rate=30.0, settings=HANDS_UNFILTERED)
    one_axis = 0.001 * math.sqrt(20) * 30**3
    assert found.value == pytest.approx(one_axis * 2 * math.sqrt(2 / math.pi), rel=0.03)


def test_the_filter_keeps_gestures_and_removes_jitter():
    time = np.arange(600) / 30
    gesture = along_x(0.2 * np.sin(2 * np.pi * 1.0 * time))
    jitter = gesture + np.random.default_rng(0).normal(0, 0.002, gesture.shape)
    clean = mean_derivative(gesture, frame_rate=30.0, settings=HANDS).value
    assert clean == pytest.approx(
        mean_derivative(gesture, frame_rate=30.0, settings=HANDS_UNFILTERED).value, rel=0.05
    )
    filtered = mean_derivative(jitter, frame_rate=30.0, settings=HANDS).value
    unfiltered = mean_derivative(jitter, frame_rate=30.0, settings=HANDS_UNFILTERED).value
    assert filtered < 0.4 * unfiltered


def test_stillness_has_no_jerk():
    assert mean_derivative(
        np.ones((40, 2, 3)), frame_rate=30.0, settings=HANDS
    ).value == pytest.approx(0, abs=1e-6)


def test_a_clip_too_short_or_too_slow_has_no_score_but_a_reason():
    short = mean_derivative(np.zeros((15, 2, 3)), frame_rate=30.0, settings=HANDS)
    assert math.isnan(short.value)
    assert "fewer than 16 frames" in short.reason
    slow = mean_derivative(np.zeros((40, 2, 3)), frame_rate=10.0, settings=HANDS)
    assert math.isnan(slow.value)
    assert "10 fps is too slow" in slow.reason


def test_settings_tell_joints_rate_and_filter():
    settings = mean_derivative(np.zeros((40, 2, 3)), frame_rate=25.0, settings=HANDS).settings
    assert settings["joints"] == "left_wrist, right_wrist"
    assert settings["frame rate"] == "25 fps"
    assert "6 Hz" in settings["filter"]
    other = mean_derivative(
        np.zeros((40, 2, 3)), frame_rate=25.0, settings=replace(HANDS, cutoff=None)
    )
    assert other.settings["filter"] == "none"


def test_a_steady_acceleration_is_found():
    time = np.arange(20) / 25
    positions = np.zeros((20, 8, 3))
    positions[:, :, 1] = 0.5 * 3.0 * time[:, None] ** 2
    found = mean_derivative(positions, frame_rate=25.0, settings=GENEA_ACCELERATION)
    assert found.value == pytest.approx(3.0)
    assert found.unit == "m/s²"
    few = mean_derivative(positions[:2], frame_rate=25.0, settings=GENEA_ACCELERATION)
    assert few.reason == "the clip has fewer than 3 frames"


def feet(frames=60, *, speed=0.0, frame_rate=30.0, lifted=0.0):
    """Return two feet, side by side, of which the second is lifted and both glide along z."""
    positions = np.zeros((frames, 2, 3))
    positions[:, 0, 0] = 0.2
    positions[:, :, 2] = speed * np.arange(frames)[:, None] / frame_rate
    positions[:, 1, 1] = lifted
    return positions


@pytest.mark.parametrize("frame_rate", [15.0, 60.0])
def test_gliding_feet_slide_as_fast_as_they_glide(frame_rate):
    found = foot_sliding(feet(speed=0.4, frame_rate=frame_rate), frame_rate=frame_rate)
    assert found.value == pytest.approx(0.4)
    assert found.unit == "m/s"


def test_standing_feet_do_not_slide():
    assert foot_sliding(feet(), frame_rate=30).value == 0


def test_a_foot_in_the_air_may_move():
    found = foot_sliding(feet(speed=0.4, lifted=0.1), frame_rate=30)
    assert found.n == 59
    assert found.value == pytest.approx(0.4)
    walking = feet(lifted=0.1)
    walking[:, 1, 2] = np.linspace(0, 2, 60)
    assert foot_sliding(walking, frame_rate=30).value == 0


def test_sliding_fades_with_height():
    half = foot_sliding(feet(speed=0.4, lifted=CONTACT_HEIGHT / 2), frame_rate=30)
    expected = 0.4 * (1 + 2 - math.sqrt(2)) / 2
    assert half.value == pytest.approx(expected)


def test_where_the_body_stands_and_which_way_it_faces_does_not_matter():
    gliding = feet(speed=0.3)
    turned = gliding[..., [2, 1, 0]] + [3.0, 1.0, -2.0]
    assert foot_sliding(turned, frame_rate=30).value == pytest.approx(
        foot_sliding(gliding, frame_rate=30).value
    )


def test_feet_that_never_stand_have_no_score_but_a_reason():
    flying = feet()
    flying[::2, :, 1] = 1.0
    found = foot_sliding(flying, frame_rate=30)
    assert math.isnan(found.value)
    assert "no foot stays" in found.reason
    assert foot_sliding(feet(1), frame_rate=30).reason == "a speed needs two frames"


def test_clips_are_compared_at_the_slowest_rate_up_to_thirty():
    assert common_frame_rate({15.0, 30.0}) == 15.0
    assert common_frame_rate({60.0, 120.0}) == 30.0
    assert common_frame_rate([25.0]) == 25.0


def test_joints_are_selected_by_name_in_the_order_asked(waving):
    positions = joint_motion(waving(), 30.0).relative
    left, right = (select(positions, [name])[:, 0] for name in ("left_wrist", "right_wrist"))
    both = select(positions, ["right_wrist", "left_wrist"])
    np.testing.assert_array_equal(both[:, 0], right)
    np.testing.assert_array_equal(both[:, 1], left)
    assert left[0, 0] > 0 > right[0, 0]
