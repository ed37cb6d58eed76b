from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.placement import SINKS_AT_MOST, ground_height, place, sole_heights, stand_on_ground
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import clip_of


def upright_clip(seed: int, frames: int = 6) -> MotionClip:
    """Return a clip of a person who leans and looks around a little while walking."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-0.3, 0.3, (frames, 55, 3))
    return clip_of(poses, rng.uniform(-1, 1, (frames, 3)))


def turned_world(clip: MotionClip, turn: Rotation, shift: np.ndarray) -> MotionClip:
    poses = clip.poses.copy()
    poses[:, 0] = (turn * Rotation.from_rotvec(clip.poses[:, 0])).as_rotvec()
    return clip_of(poses, turn.apply(clip.trans) + shift)


AXES = {
    "y": Rotation.identity(),
    "z": Rotation.from_euler("x", 90, degrees=True),
    "-z": Rotation.from_euler("x", -90, degrees=True),
    "-y": Rotation.from_euler("x", 180, degrees=True),
    "x": Rotation.from_euler("z", -90, degrees=True),
    "-x": Rotation.from_euler("z", 90, degrees=True),
}


@given(
    seed=st.integers(0, 99),
    axis=st.sampled_from(sorted(AXES)),
    heading=st.floats(-180, 180),
    shift=st.tuples(*[st.floats(-5, 5)] * 3),
)
@settings(max_examples=40)
def test_placement_does_not_depend_on_the_world_axes(
    seed: int, axis: str, heading: float, shift: tuple[float, float, float]
) -> None:
    clip = upright_clip(seed)
    elsewhere = turned_world(
        clip, AXES[axis] * Rotation.from_euler("y", heading, degrees=True), np.array(shift)
    )
    first, second = (
        forward_kinematics(placed.poses, placed.trans, REST_JOINTS)
        for placed in (place(clip)[0], place(elsewhere)[0])
    )
    np.testing.assert_allclose(first[1], second[1], atol=1e-4)
    np.testing.assert_allclose(first[0], second[0], atol=1e-4)


@given(st.integers(0, 99))
@settings(max_examples=20)
def test_placed_body_stands_on_the_floor_facing_z(seed: int) -> None:
    placed, _ = place(upright_clip(seed))
    _, rotations = forward_kinematics(placed.poses, placed.trans, REST_JOINTS)
    standing = np.median(sole_heights(placed, REST_JOINTS))
    assert standing == pytest.approx(ground_height(REST_JOINTS), abs=1e-5)
    np.testing.assert_allclose(placed.trans[:, [0, 2]].mean(axis=0), 0, atol=1e-5)
    facing = (rotations[:, 0] @ [0, 0, 1]).mean(axis=0)
    assert facing[0] == pytest.approx(0, abs=1e-5)
    assert facing[2] > 0


def test_turns_of_a_placed_clip_are_noted() -> None:
    clip = clip_of(np.zeros((2, 55, 3)))
    assert place(clip)[1] == ()
    turn = AXES["z"] * Rotation.from_euler("y", 90, degrees=True)
    _, notes = place(turned_world(clip, turn, np.zeros(3)))
    assert notes == ("z was up; turned to y up", "turned by -90 degrees to face +z")


GROUND = ground_height(REST_JOINTS)


@given(seed=st.integers(0, 9999), frames=st.sampled_from([1, 2, 5, 90]))
def test_soles_stay_within_the_limit_below_the_ground(seed: int, frames: int) -> None:
    clip = clip_of(upright_clip(seed, frames).poses)
    standing = stand_on_ground(clip, REST_JOINTS)
    assert sole_heights(standing, REST_JOINTS).min() > GROUND - SINKS_AT_MOST - 1e-5


def test_motion_with_changing_height_is_unchanged() -> None:
    clip = upright_clip(0)
    heights = np.linspace(0, [0, 0.001, 0], len(clip), dtype=np.float32)
    moving = replace(clip, trans=heights)
    assert stand_on_ground(moving, REST_JOINTS) is moving


def test_slowly_bent_knees_lower_the_body_but_not_the_feet() -> None:
    frames = 120
    bend = 0.5 * (1 - np.cos(np.linspace(0, 2 * np.pi, frames)))
    poses = np.zeros((frames, 55, 3))
    for side in ("left", "right"):
        for part, share in (("hip", -0.4), ("knee", 0.8), ("ankle", -0.4)):
            poses[:, joint_index(f"{side}_{part}"), 0] = share * bend
    clip = clip_of(poses)
    standing = stand_on_ground(clip, REST_JOINTS)
    assert standing.trans[60, 1] < -0.05
    np.testing.assert_allclose(sole_heights(standing, REST_JOINTS), GROUND, atol=0.002)


def test_noise_in_the_legs_does_not_make_the_body_tremble() -> None:
    rng = np.random.default_rng(0)
    poses = np.zeros((300, 55, 3))
    for name in ("left_hip", "right_hip", "left_knee", "right_knee"):
        poses[:, joint_index(name)] = rng.normal(0, 0.01, (300, 3))
    clip = clip_of(poses)
    trembling = np.diff(GROUND - sole_heights(clip, REST_JOINTS), n=2).std()
    standing = stand_on_ground(clip, REST_JOINTS)
    assert np.diff(standing.trans[:, 1].astype(float), n=2).std() < 0.1 * trembling
