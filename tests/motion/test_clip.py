from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation, Slerp

from motion.clip import CHANNELS, MotionClip, freeze, moving_channels
from motion.errors import InputError
from motion.resample import cut, resample
from motion.skeleton import JOINT_NAMES, REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import assert_same_clip, clip_of, random_clip

STILL: dict[str, Any] = {"poses": np.zeros((4, 55, 3)), "trans": np.zeros((4, 3)), "frame_rate": 30}


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int64])
def test_a_clip_keeps_read_only_float32_copies(kind: type[np.number[Any]]) -> None:
    poses = np.zeros((4, 55, 3), kind)
    original = MotionClip(**STILL | {"poses": poses})
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
        ({"arkit": np.zeros((4, 51))}, r"arkit has shape.*\(4, 52\).*expected width"),
        ({"arkit": np.full((4, 52), 100.0)}, "arkit weights"),
        ({"arkit": np.full((4, 52), -0.1)}, "arkit weights"),
        ({"poses": np.full((4, 55, 3), np.nan)}, r"poses holds nan at index \(0, 0, 0\)"),
        ({"poses": np.full((4, 55, 3), 60)}, r"poses holds 60 .*radians \(not degrees\)"),
        ({"trans": np.full((4, 3), 1e300)}, r"trans holds 1e\+300 at index \(0, 0\)"),
        ({"frame_rate": 0}, "frame rate"),
        ({"frame_rate": 1001}, "frame rate"),
        ({"frame_rate": float("nan")}, "frame rate"),
        ({"gender": "robot"}, "gender"),
    ],
)
def test_a_clip_refuses_invalid_arrays(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        MotionClip(**STILL | changes)


JOINTS = {
    "face": {"jaw", "left_eye", "right_eye"},
    "hands": {name for name in JOINT_NAMES if name[-1] in "123" and "spine" not in name},
    "lower_body": {
        f"{side}_{part}" for side in ("left", "right") for part in ("hip", "knee", "ankle", "foot")
    },
    "root": {"pelvis"},
}


@given(channels=st.sets(st.sampled_from(CHANNELS)), seed=st.integers(0, 99), face=st.booleans())
def test_only_the_named_channels_become_still(channels: set[str], seed: int, face: bool) -> None:
    clip = random_clip(seed=seed, face=face)
    frozen = freeze(clip, channels)
    still = {name for channel in channels for name in JOINTS[channel]}
    for name in JOINT_NAMES:
        before, after = (one.poses[:, joint_index(name)] for one in (clip, frozen))
        if name in still:
            assert np.ptp(after, axis=0).max() == 0, name
        else:
            np.testing.assert_array_equal(before, after, err_msg=name)
    assert bool(np.any(frozen.trans)) == ("root" not in channels)
    for channel in (frozen.expressions, frozen.arkit):
        assert (channel is None) == (not face)
        assert bool(np.any(channel)) == (face and "face" not in channels)
    assert_same_clip(freeze(frozen, channels), frozen)


def test_frozen_hands_are_mirror_images_with_fingers_towards_the_palm() -> None:
    frozen = freeze(MotionClip(**STILL), ["hands"])
    positions, _ = forward_kinematics(frozen.poses, frozen.trans, REST_JOINTS)
    for finger in ("index", "middle", "ring", "pinky"):
        left, right = (positions[0, joint_index(f"{s}_{finger}3")] for s in ("left", "right"))
        np.testing.assert_allclose(left, right * [-1, 1, 1], atol=1e-6)
        assert left[1] < REST_JOINTS[joint_index(f"left_{finger}3"), 1] - 0.01


@pytest.mark.parametrize(
    ("array", "place", "change", "moving"),
    [
        ("poses", (1, joint_index("jaw"), 0), 0.005, set()),  # a network's residual noise
        ("poses", (3, joint_index("left_index2"), 1), 0.2, {"hands"}),
        ("trans", (2, 0), 0.1, {"root"}),
        ("arkit", (4, 0), -0.5, {"face"}),
    ],
)
def test_a_channel_moves_when_anything_of_it_visibly_changes_over_time(
    array: str, place: tuple[int, ...], change: float, moving: set[str]
) -> None:
    still = replace(random_clip(frames=1), arkit=np.full((1, 52), 0.5, np.float32))
    still = still.frames(np.zeros(5, dtype=int))
    changed = getattr(still, array).copy()
    changed[place] += change
    assert moving_channels(replace(still, **{array: changed})) == moving


RATES = st.sampled_from([12.5, 15.0, 24.0, 25.0, 29.97, 30.0, 60.0, 120.0])


@given(frames=st.integers(1, 200), old=RATES, new=RATES)
def test_resampling_keeps_the_duration_within_half_a_frame(
    frames: int, old: float, new: float
) -> None:
    clip = random_clip(frames, old)
    resampled = resample(clip, new)
    assert resampled.frame_rate == new
    assert len(resampled) == max(1, round(clip.duration * new))


@given(seed=st.integers(0, 1000), factor=st.integers(2, 5))
def test_frames_that_coincide_with_source_frames_are_kept(seed: int, factor: int) -> None:
    clip = random_clip(10, 30, seed)
    finer = resample(clip, 30 * factor)
    assert_same_clip(resample(finer, 30), clip)


def test_rotations_are_interpolated_spherically_and_everything_else_linearly() -> None:
    clip = random_clip(6, 10)
    given_times, times = np.arange(6) / 10, np.arange(13) / 25
    result = resample(clip, 25)
    slerp = Slerp(given_times, Rotation.from_rotvec(clip.poses[:, 16]))
    np.testing.assert_allclose(result.poses[:13, 16], slerp(times).as_rotvec(), atol=1e-5)
    for name in ("trans", "expressions", "arkit"):
        line = make_interp_spline(given_times, getattr(clip, name), k=1)
        np.testing.assert_allclose(getattr(result, name)[:13], line(times), atol=1e-5)


def test_a_rotation_takes_the_shorter_way() -> None:
    poses = np.zeros((2, 55, 3))
    poses[:, 0, 1] = np.radians([170, -170])
    clip = clip_of(poses, frame_rate=1)
    middle = resample(clip, 2).poses[1, 0]
    assert np.abs(middle[1]) == pytest.approx(np.pi, abs=1e-5)


def test_a_cut_has_all_channels_and_repeats_the_last_frame_at_a_short_end() -> None:
    clip = random_clip(30, 30)
    excerpt = cut(clip, 0.5, 1.1)
    for name in ("poses", "trans", "expressions", "arkit"):
        whole, part = getattr(clip, name), getattr(excerpt, name)
        np.testing.assert_array_equal(part[:15], whole[15:], err_msg=name)
        np.testing.assert_array_equal(part[15:], whole[[-1] * 3], err_msg=name)
