from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.ground import ground_height, sole_heights
from motion.placement import place
from motion.rest_pose import REST_JOINTS
from motion.skeleton import forward_kinematics


def upright_clip(seed: int, frames: int = 6) -> MotionClip:
    """Return a clip of someone who leans and looks about a little while walking."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-0.3, 0.3, (frames, 55, 3))
    return MotionClip(poses=poses, trans=rng.uniform(-1, 1, (frames, 3)), frame_rate=30)


def turned_world(clip: MotionClip, turn: Rotation, shift: np.ndarray) -> MotionClip:
    poses = clip.poses.copy()
    poses[:, 0] = (turn * Rotation.from_rotvec(clip.poses[:, 0])).as_rotvec()
    return MotionClip(poses=poses, trans=turn.apply(clip.trans) + shift, frame_rate=30)


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
def test_same_motion_in_any_world_is_placed_alike(
    seed: int, axis: str, heading: float, shift: tuple[float, float, float]
) -> None:
    clip = upright_clip(seed)
    elsewhere = turned_world(
        clip, AXES[axis] * Rotation.from_euler("y", heading, degrees=True), np.array(shift)
    )
    here, there = (
        forward_kinematics(placed.poses, placed.trans, REST_JOINTS)
        for placed in (place(clip)[0], place(elsewhere)[0])
    )
    np.testing.assert_allclose(here[1], there[1], atol=1e-4)
    np.testing.assert_allclose(here[0], there[0], atol=1e-4)


@given(st.integers(0, 99))
@settings(max_examples=20)
def test_placed_body_stands_on_the_floor_facing_z(seed: int) -> None:
    placed, _ = place(upright_clip(seed))
    _, turned = forward_kinematics(placed.poses, placed.trans, REST_JOINTS)
    standing = np.median(sole_heights(placed, REST_JOINTS))
    assert standing == pytest.approx(ground_height(REST_JOINTS), abs=1e-5)
    np.testing.assert_allclose(placed.trans[:, [0, 2]].mean(axis=0), 0, atol=1e-5)
    facing = (turned[:, 0] @ [0, 0, 1]).mean(axis=0)
    assert facing[0] == pytest.approx(0, abs=1e-5)
    assert facing[2] > 0


def test_only_the_pelvis_and_translation_change() -> None:
    clip = turned_world(upright_clip(0), AXES["z"], np.ones(3))
    placed, _ = place(clip)
    np.testing.assert_array_equal(placed.poses[:, 1:], clip.poses[:, 1:])


def test_placing_again_changes_nothing() -> None:
    placed, _ = place(upright_clip(3))
    again, notes = place(placed)
    np.testing.assert_allclose(again.poses, placed.poses, atol=1e-5)
    np.testing.assert_allclose(again.trans, placed.trans, atol=1e-5)
    assert notes == ()


def test_what_was_turned_is_said() -> None:
    clip = MotionClip(poses=np.zeros((2, 55, 3)), trans=np.zeros((2, 3)), frame_rate=30)
    assert place(clip)[1] == ()
    turn = AXES["z"] * Rotation.from_euler("y", 90, degrees=True)
    _, notes = place(turned_world(clip, turn, np.zeros(3)))
    assert notes == ("z was up; turned to y up", "turned by -90 degrees to face +z")
