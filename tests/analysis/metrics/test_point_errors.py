import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.metrics.point_errors import (
    MACE_POSES,
    MAJE,
    SEED_FRAMES,
    Norm,
    box_scale,
    point_error,
    velocity_error,
)
from motion.arrays import Floats


def motion(seed: int = 0, shape: tuple[int, ...] = (40, 5, 3)) -> Floats:
    return np.random.default_rng(seed).standard_normal(shape)


def maje(one: Floats, other: Floats, scale: float = 1.0) -> float:
    return point_error(one, other, frame_rate=15, settings=MAJE, scale=scale).value


def mace(one: Floats, other: Floats, frame_rate: float = 15.0) -> float:
    return point_error(one, other, frame_rate=frame_rate, settings=MACE_POSES).value


def velocity(one: Floats, other: Floats, norm: Norm = "L1", frame_rate: float = 30.0) -> float:
    return velocity_error(one, other, frame_rate=frame_rate, norm=norm).value


def test_a_shift_on_one_axis_counts_a_third_in_millimetres() -> None:
    shifted = motion() + np.array([0.3, 0, 0])
    assert maje(shifted, motion()) == pytest.approx(100)
    assert maje(shifted, motion(), scale=0.5) == pytest.approx(50)


def test_a_constant_shift_has_no_error_of_velocity_or_acceleration() -> None:
    shifted = motion() + np.array([0.3, -1, 2])
    assert mace(shifted, motion()) == pytest.approx(0, abs=1e-6)
    assert velocity(shifted, motion()) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("frame_rate", [15.0, 30.0, 60.0])
def test_velocity_and_acceleration_errors_do_not_depend_on_the_frame_rate(
    frame_rate: float,
) -> None:
    time = np.arange(2 * frame_rate) / frame_rate
    falling = np.zeros((len(time), 1, 3))
    falling[:, 0, 1] = -0.5 * 9.81 * time**2
    still = np.zeros_like(falling)
    assert mace(falling, still, frame_rate) == pytest.approx(9810 / 3)
    walking = time[:, None, None] * np.array([[[0.3, 0.0, 0.4]]])
    assert velocity(walking, still, "L2", frame_rate) == pytest.approx(0.5)
    assert velocity(walking, still, "L1", frame_rate) == pytest.approx(0.7 / 3)


def test_seed_frames_do_not_count() -> None:
    seeded = motion()
    seeded[:SEED_FRAMES] += 5
    assert maje(seeded, motion()) == 0
    assert mace(seeded, motion()) == 0
    whole = point_error(seeded, motion(), frame_rate=15, settings=MAJE)
    assert whole.settings["left out"] == "the first 4 frames"
    assert whole.n == 36 * 5


@given(st.integers(0, 1000), st.floats(0.1, 10))
def test_errors_are_distances_that_grow_with_the_motion(seed: int, scale: float) -> None:
    one, other = motion(seed), motion(seed + 1)
    for error in (maje, mace, velocity):
        assert error(one, one) == 0
        assert error(one, other) == pytest.approx(error(other, one))
        assert error(scale * one, scale * other) == pytest.approx(scale * error(one, other))


def test_points_are_scaled_to_a_box_of_one_metre() -> None:
    clips = [motion(3) * 0.2, motion(4) * 3 + 1]
    scale = box_scale(clips)
    together = scale * np.concatenate([clip.reshape(-1, 3) for clip in clips])
    assert np.linalg.norm(np.ptp(together, axis=0)) == pytest.approx(1)
    for without_extent in ([], [np.ones((3, 2, 3))]):
        assert math.isnan(box_scale(without_extent))


def test_too_few_frames_and_unequal_lengths_give_a_reason() -> None:
    whole = motion()
    for result, reason in (
        (point_error(whole[:4], whole[:4], frame_rate=15, settings=MAJE), "no frame after those"),
        (point_error(whole[:6], whole[:6], frame_rate=15, settings=MACE_POSES), "fewer than 3"),
        (
            point_error(whole[:20], whole, frame_rate=15, settings=MAJE),
            "20 frames and the recording 40",
        ),
        (velocity_error(whole[:1], whole[:1], frame_rate=30, norm="L1"), "two frames"),
    ):
        assert math.isnan(result.value)
        assert reason in result.reason
    assert point_error(whole[:39], whole, frame_rate=15, settings=MAJE).n == 35 * 5
