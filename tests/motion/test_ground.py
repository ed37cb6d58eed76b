from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.clip import MotionClip
from motion.ground import SINKS_AT_MOST, ground_height, sole_heights, stand_on_ground
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index

GROUND = ground_height(REST_JOINTS)


def _stepping(seed: int, frames: int = 90, rate: float = 30) -> MotionClip:
    """Return a clip whose legs and pelvis turn smoothly, and which stays at one place."""
    rng = np.random.default_rng(seed)
    time = np.arange(frames)[:, None] / rate
    poses = np.zeros((frames, 55, 3))
    names = ("pelvis", *(f"{s}_{p}" for s in ("left", "right") for p in ("hip", "knee", "ankle")))
    for name in names:
        speed, start = rng.uniform(1, 8, 3), rng.uniform(0, 6, 3)
        poses[:, joint_index(name)] = rng.uniform(0, 0.5) * np.sin(speed * time + start)
    place = rng.uniform(-1, 1, 3)
    return MotionClip(poses=poses, trans=np.tile(place, (frames, 1)), frame_rate=rate)


@given(seed=st.integers(0, 9999), rate=st.sampled_from([15, 30, 60]))
def test_no_sole_is_further_below_the_ground_than_it_may(seed: int, rate: float) -> None:
    standing = stand_on_ground(_stepping(seed, rate=rate), REST_JOINTS)
    assert sole_heights(standing, REST_JOINTS).min() > GROUND - SINKS_AT_MOST - 1e-5


@given(seed=st.integers(0, 9999))
def test_only_the_height_is_changed(seed: int) -> None:
    clip = _stepping(seed)
    standing = stand_on_ground(clip, REST_JOINTS)
    np.testing.assert_array_equal(standing.poses, clip.poses)
    np.testing.assert_array_equal(standing.trans[:, [0, 2]], clip.trans[:, [0, 2]])


@given(seed=st.integers(0, 9999), sway=st.floats(0.001, 1))
def test_motion_with_a_height_of_its_own_is_left_as_it_is(seed: int, sway: float) -> None:
    clip = _stepping(seed)
    trans = clip.trans + [0, sway, 0] * np.linspace(0, 1, len(clip))[:, None]
    moving = replace(clip, trans=trans)
    assert stand_on_ground(moving, REST_JOINTS) is moving


@given(seed=st.integers(0, 9999))
def test_feet_that_stay_are_on_the_ground_exactly(seed: int) -> None:
    clip = _stepping(seed).frames(np.zeros(40, int))
    standing = stand_on_ground(clip, REST_JOINTS)
    np.testing.assert_allclose(sole_heights(standing, REST_JOINTS), GROUND, atol=1e-5)


def test_slow_bending_of_the_knees_lowers_the_body_and_leaves_the_feet() -> None:
    frames = 120
    bend = 0.5 * (1 - np.cos(np.linspace(0, 2 * np.pi, frames)))
    poses = np.zeros((frames, 55, 3))
    for side in ("left", "right"):
        for part, share in (("hip", -0.4), ("knee", 0.8), ("ankle", -0.4)):
            poses[:, joint_index(f"{side}_{part}"), 0] = share * bend
    clip = MotionClip(poses=poses, trans=np.zeros((frames, 3)), frame_rate=30)
    standing = stand_on_ground(clip, REST_JOINTS)
    assert standing.trans[60, 1] < -0.05
    np.testing.assert_allclose(sole_heights(standing, REST_JOINTS), GROUND, atol=0.002)


def test_noise_in_the_legs_does_not_make_the_body_tremble() -> None:
    rng = np.random.default_rng(0)
    poses = np.zeros((300, 55, 3))
    for name in ("left_hip", "right_hip", "left_knee", "right_knee"):
        poses[:, joint_index(name)] = rng.normal(0, 0.01, (300, 3))
    clip = MotionClip(poses=poses, trans=np.zeros((300, 3)), frame_rate=30)
    trembling = np.diff(GROUND - sole_heights(clip, REST_JOINTS), n=2).std()
    standing = stand_on_ground(clip, REST_JOINTS)
    assert np.diff(standing.trans[:, 1].astype(float), n=2).std() < 0.1 * trembling


@pytest.mark.parametrize("frames", [1, 2, 5])
def test_the_shortest_clips_stand_too(frames: int) -> None:
    standing = stand_on_ground(_stepping(3, frames=frames), REST_JOINTS)
    assert sole_heights(standing, REST_JOINTS).min() > GROUND - SINKS_AT_MOST - 1e-5
