from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from motion.clip import MotionClip
from motion.errors import InputError
from motion.resample import cut, resample
from tests.motion.random_clips import assert_same_clip, clip_of, random_clip

RATES = st.sampled_from([12.5, 15.0, 24.0, 25.0, 29.97, 30.0, 60.0, 120.0])


def turning(degrees_per_second: float, frame_rate: float, frames: int) -> MotionClip:
    """Return a clip whose neck turns steadily."""
    poses = np.zeros((frames, 55, 3))
    poses[:, 12, 1] = np.radians(degrees_per_second) * np.arange(frames) / frame_rate
    return clip_of(poses, frame_rate=frame_rate)


@given(frames=st.integers(1, 200), old=RATES, new=RATES)
def test_duration_is_kept_to_half_a_frame(frames: int, old: float, new: float) -> None:
    clip = turning(10, old, frames)
    resampled = resample(clip, new)
    assert resampled.frame_rate == new
    assert len(resampled) == max(1, round(clip.duration * new))


@given(seed=st.integers(0, 1000), factor=st.integers(2, 5))
def test_frames_that_fall_on_given_ones_are_kept(seed: int, factor: int) -> None:
    clip = random_clip(10, 30, seed)
    finer = resample(clip, 30 * factor)
    assert_same_clip(resample(finer, 30), clip)


def test_rotations_follow_the_sphere() -> None:
    clip = random_clip(6, 10)
    times = np.arange(15) / 25
    result = resample(clip, 25).poses[:, 16]
    slerp = Slerp(np.arange(6) / 10, Rotation.from_rotvec(clip.poses[:, 16]))
    inside = times <= 0.5
    np.testing.assert_allclose(result[inside], slerp(times[inside]).as_rotvec(), atol=1e-5)


def test_turn_goes_the_short_way_round() -> None:
    poses = np.zeros((2, 55, 3))
    poses[:, 0, 1] = np.radians([170, -170])
    clip = clip_of(poses, frame_rate=1)
    middle = resample(clip, 2).poses[1, 0]
    assert np.abs(middle[1]) == pytest.approx(np.pi, abs=1e-5)


@pytest.mark.parametrize("rate", [0, -30, float("nan"), 1e12])
def test_unusable_rate_is_refused(rate: float) -> None:
    with pytest.raises(InputError, match="frame rate"):
        resample(random_clip(), rate)


@given(start=st.floats(0, 1.5), length=st.floats(0.05, 1.5), rate=RATES)
def test_cut_has_exactly_the_frames_asked_for(start: float, length: float, rate: float) -> None:
    clip = turning(10, rate, round(3 * rate))
    excerpt = cut(clip, start, start + length)
    assert len(excerpt) == round((start + length - start) * rate)
    first = round(start * rate)
    expected = clip.poses[np.minimum(np.arange(first, first + len(excerpt)), len(clip) - 1)]
    np.testing.assert_array_equal(excerpt.poses, expected)


def test_cut_holds_the_last_frame_over_a_short_end_and_refuses_what_lies_outside() -> None:
    clip = random_clip(30, 30)
    excerpt = cut(clip, 0.5, 1.1)
    assert len(excerpt) == 18
    np.testing.assert_array_equal(excerpt.poses[-4:], np.repeat(clip.poses[-1:], 4, axis=0))
    with pytest.raises(InputError, match="excerpt"):
        cut(clip, 0.5, 1.2)
