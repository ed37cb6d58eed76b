from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from analysis.metrics.point_errors import (
    MACE_LANDMARKS,
    MACE_POSES,
    MAJE,
    MALE,
    SEED_FRAMES,
    Norm,
    box_scale,
    paired,
    point_error,
    velocity_error,
)

FloatArray = NDArray[np.float64]


def motion(seed: int = 0, shape: tuple[int, ...] = (40, 5, 3)) -> FloatArray:
    return np.random.default_rng(seed).standard_normal(shape)


def maje(one: FloatArray, other: FloatArray, scale: float = 1.0) -> float:
    return point_error(one, other, frame_rate=15, settings=MAJE, scale=scale).value


def mace(one: FloatArray, other: FloatArray, frame_rate: float = 15.0) -> float:
    return point_error(one, other, frame_rate=frame_rate, settings=MACE_POSES).value


def velocity(
    one: FloatArray, other: FloatArray, norm: Norm = "L1", frame_rate: float = 30.0
) -> float:
    return velocity_error(one, other, frame_rate=frame_rate, norm=norm).value


def test_a_shift_on_one_axis_is_a_third_of_it_in_millimetres() -> None:
    shifted = motion() + np.array([0.3, 0, 0])
    assert maje(shifted, motion()) == pytest.approx(100)
    assert maje(shifted, motion(), scale=0.5) == pytest.approx(50)


def test_what_stays_apart_moves_alike() -> None:
    shifted = motion() + np.array([0.3, -1, 2])
    assert mace(shifted, motion()) == pytest.approx(0, abs=1e-6)
    assert velocity(shifted, motion()) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("frame_rate", [15.0, 30.0, 60.0])
def test_an_acceleration_is_the_same_at_every_frame_rate(frame_rate: float) -> None:
    time = np.arange(2 * frame_rate) / frame_rate
    falling = np.zeros((len(time), 1, 3))
    falling[:, 0, 1] = -0.5 * 9.81 * time**2
    assert mace(falling, np.zeros_like(falling), frame_rate) == pytest.approx(9810 / 3)


@pytest.mark.parametrize("frame_rate", [15.0, 60.0])
def test_a_velocity_is_the_same_at_every_frame_rate(frame_rate: float) -> None:
    time = np.arange(2 * frame_rate) / frame_rate
    walking = time[:, None, None] * np.array([[[0.3, 0.0, 0.4]]])
    still = np.zeros_like(walking)
    assert velocity(walking, still, "L2", frame_rate) == pytest.approx(0.5)
    assert velocity(walking, still, "L1", frame_rate) == pytest.approx(0.7 / 3)


def test_frames_that_seed_the_generator_do_not_count() -> None:
    seeded = motion()
    seeded[:SEED_FRAMES] += 5
    assert maje(seeded, motion()) == 0
    assert mace(seeded, motion()) == 0
    whole = point_error(seeded, motion(), frame_rate=15, settings=MAJE)
    assert whole.settings["left out"] == "the first 4 frames"
    assert whole.n == 36 * 5


def test_landmarks_are_measured_as_joints_are() -> None:
    one, other = motion(1), motion(2)
    landmarks = point_error(one, other, frame_rate=15, settings=MALE)
    assert landmarks.value == maje(one, other)
    assert "MALE" in landmarks.name
    accelerated = point_error(one, other, frame_rate=15, settings=MACE_LANDMARKS)
    assert accelerated.value == mace(one, other)
    assert (landmarks.unit, accelerated.unit) == ("mm", "mm/s²")


@given(st.integers(0, 1000), st.floats(0.1, 10))
def test_errors_are_distances_that_grow_with_the_motion(seed: int, scale: float) -> None:
    one, other = motion(seed), motion(seed + 1)
    for error in (maje, mace, velocity):
        assert error(one, one) == 0
        assert error(one, other) == pytest.approx(error(other, one))
        assert error(scale * one, scale * other) == pytest.approx(scale * error(one, other))


def test_all_points_fit_a_box_of_one_metre_afterwards() -> None:
    clips = [motion(3) * 0.2, motion(4) * 3 + 1]
    scale = box_scale(clips)
    together = scale * np.concatenate([clip.reshape(-1, 3) for clip in clips])
    assert np.linalg.norm(np.ptp(together, axis=0)) == pytest.approx(1)


@pytest.mark.parametrize("clips", [[], [np.ones((3, 2, 3))]])
def test_no_extent_is_no_scale(clips: Sequence[FloatArray]) -> None:
    with pytest.raises(ValueError, match=r"clip|coincide"):
        box_scale(clips)


@pytest.mark.parametrize("error", [maje, mace])
def test_a_clip_of_nothing_but_seeds_has_no_error(error: Callable[..., float]) -> None:
    assert math.isnan(error(motion(shape=(4, 2, 3)), motion(shape=(4, 2, 3))))


def test_reasons_are_given() -> None:
    one = np.zeros((1, 2, 3))
    assert velocity_error(one, one, frame_rate=30, norm="L1").reason == (
        "a velocity needs two frames"
    )
    short = point_error(
        motion(shape=(6, 2, 3)), motion(shape=(6, 2, 3)), frame_rate=15, settings=MACE_POSES
    )
    assert "fewer than 3 frames" in short.reason
    apart = point_error(
        motion(shape=(20, 2, 3)), motion(shape=(40, 2, 3)), frame_rate=15, settings=MAJE
    )
    assert "20 frames and the recording 40" in apart.reason


def test_without_points_the_settings_say_that_nothing_was_scaled() -> None:
    assert MAJE.described(15.0, math.nan)["scale"] == "none: no points"


def test_clips_are_cut_to_the_shorter_one() -> None:
    one, other, reason = paired(np.zeros((30, 2, 3)), np.zeros((29, 2, 3)))
    assert (len(one), len(other), reason) == (29, 29, "")


def test_frames_of_different_joints_never_pair() -> None:
    with pytest.raises(ValueError, match="shapes"):
        paired(np.zeros((5, 2, 3)), np.zeros((5, 4, 3)))


def test_no_frame_is_said() -> None:
    assert paired(np.zeros((0, 2)), np.zeros((0, 2)))[2] == "a clip has no frame"
