from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from motion.clip import CHANNELS, MotionClip, freeze, moving_channels
from motion.errors import InputError
from motion.resample import cut, resample
from motion.skeleton import JOINT_NAMES, joint_index
from tests.motion.random_clips import assert_same_clip, clip_of, random_clip


def clip(frames: int = 4, **changes: Any) -> MotionClip:
    fields: dict[str, Any] = {
        "poses": np.zeros((frames, 55, 3)),
        "trans": np.zeros((frames, 3)),
        "frame_rate": 30,
    }
    return MotionClip(**{**fields, **changes})


def test_a_clip_keeps_read_only_float32_copies() -> None:
    poses = np.zeros((4, 55, 3))
    original = clip(poses=poses)
    poses[0] = 1
    assert original.poses.dtype == np.float32
    assert not original.poses.any()
    with pytest.raises(ValueError, match="read-only"):
        original.poses[0] = 1


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"poses": np.zeros((4, 54, 3))}, "poses has shape"),
        ({"poses": np.zeros((0, 55, 3)), "trans": np.zeros((0, 3))}, "no frame"),
        ({"trans": np.zeros((3, 3))}, "trans has shape"),
        ({"expressions": np.zeros((4, 10))}, "expressions has shape"),
        ({"arkit": np.zeros((4, 51))}, "arkit has shape"),
        ({"arkit": np.full((4, 52), 100.0)}, "arkit weights"),
        ({"poses": np.full((4, 55, 3), np.nan)}, r"poses holds .* index \(0, 0, 0\)"),
        ({"trans": np.full((4, 3), np.inf)}, "trans holds"),
        ({"trans": np.full((4, 3), 1e300)}, r"trans holds 1e\+300 at index \(0, 0\)"),
        ({"frame_rate": 0}, "frame rate"),
        ({"frame_rate": 1e-6}, "frame rate"),
        ({"frame_rate": 1001}, "frame rate"),
        ({"frame_rate": float("nan")}, "frame rate"),
        ({"gender": "robot"}, "gender"),
    ],
)
def test_a_clip_refuses_invalid_arrays(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        clip(**changes)


def test_picking_frames_keeps_all_channels_together() -> None:
    numbers = np.arange(6, dtype=float)
    original = clip(
        frames=6,
        trans=np.repeat(numbers[:, None], 3, axis=1),
        arkit=np.repeat(numbers[:, None] / 10, 52, axis=1),
        expressions=np.repeat(numbers[:, None], 100, axis=1),
    )
    picked = original.frames(slice(2, 5))
    assert picked.arkit is not None
    assert picked.expressions is not None
    np.testing.assert_allclose(picked.trans[:, 0], [2, 3, 4])
    np.testing.assert_allclose(picked.arkit[:, 0], [0.2, 0.3, 0.4], rtol=1e-6)
    np.testing.assert_allclose(picked.expressions[:, 0], [2, 3, 4])


def test_provenance_grows_and_cannot_be_changed_in_place() -> None:
    original = clip(provenance={"generator": "static"}).with_provenance(seed="3")
    assert original.provenance == {"generator": "static", "seed": "3"}
    with pytest.raises(TypeError):
        original.provenance["seed"] = "4"  # type: ignore[index]


JOINTS = {
    "face": {"jaw", "left_eye", "right_eye"},
    "hands": {name for name in JOINT_NAMES if name[-1] in "123" and "spine" not in name},
    "lower_body": {
        f"{side}_{part}" for side in ("left", "right") for part in ("hip", "knee", "ankle", "foot")
    },
    "root": {"pelvis"},
}


@given(st.sets(st.sampled_from(CHANNELS)), st.integers(0, 99))
def test_only_the_named_channels_become_still(channels: set[str], seed: int) -> None:
    clip = random_clip(seed=seed)
    frozen = freeze(clip, channels)
    still = {name for channel in channels for name in JOINTS[channel]}
    for name in JOINT_NAMES:
        before, after = (one.poses[:, joint_index(name)] for one in (clip, frozen))
        if name in still:
            assert np.ptp(after, axis=0).max() == 0, name
        else:
            np.testing.assert_array_equal(before, after, err_msg=name)
    assert bool(np.any(frozen.trans)) == ("root" not in channels)
    assert bool(np.any(frozen.expressions)) == ("face" not in channels)
    assert bool(np.any(frozen.arkit)) == ("face" not in channels)
    assert_same_clip(freeze(frozen, channels), frozen)


def test_clip_without_a_face_stays_without() -> None:
    frozen = freeze(random_clip(face=False), ["face"])
    assert frozen.expressions is None
    assert frozen.arkit is None


def test_unknown_channel_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"'legs'.*face, hands, lower_body, root"):
        freeze(random_clip(), ["legs"])


def test_a_networks_residual_noise_is_not_taken_for_movement() -> None:
    still = random_clip(frames=1, face=False).frames(np.zeros(5, dtype=int))
    poses = still.poses.copy()
    poses[1, joint_index("jaw")] += 0.005
    assert moving_channels(replace(still, poses=poses)) == frozenset()


def test_a_channel_moves_when_anything_of_it_changes_over_time() -> None:
    still = random_clip(frames=1).frames(np.zeros(5, dtype=int))
    assert moving_channels(still) == frozenset()
    poses = still.poses.copy()
    poses[3, joint_index("left_index2"), 1] += 0.2
    assert moving_channels(replace(still, poses=poses)) == {"hands"}
    trans = still.trans.copy()
    trans[2, 0] += 0.1
    assert moving_channels(replace(still, trans=trans)) == {"root"}
    arkit = np.zeros((5, 52), np.float32)
    arkit[4, 0] = 0.5
    assert moving_channels(replace(still, arkit=arkit)) == {"face"}


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


def test_cut_repeats_the_last_frame_at_a_short_end_and_refuses_more() -> None:
    clip = random_clip(30, 30)
    excerpt = cut(clip, 0.5, 1.1)
    assert len(excerpt) == 18
    np.testing.assert_array_equal(excerpt.poses[-4:], np.repeat(clip.poses[-1:], 4, axis=0))
    with pytest.raises(InputError, match="excerpt"):
        cut(clip, 0.5, 1.2)
