from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.formats import read_motion
from motion.placement import (
    SINKS_AT_MOST,
    clear_of_body,
    ground_height,
    place,
    sole_heights,
    stand_on_ground,
)
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


FRAMES, RATE = 90, 30


def _with_left_arm(adduction: np.ndarray, seed: int = 0) -> MotionClip:
    """Return a clip whose left arm hangs by `adduction` degrees per frame; 90 is straight down."""
    rng = np.random.default_rng(seed)
    poses = np.zeros((len(adduction), 55, 3))
    poses[:, joint_index("left_shoulder"), 2] = -np.radians(adduction)
    poses[:, joint_index("right_shoulder"), 2] = np.radians(50)
    poses[:, joint_index("left_elbow"), 1] = rng.uniform(-0.3, 0)
    poses[:, 0] = Rotation.from_euler("y", rng.uniform(-180, 180), degrees=True).as_rotvec()
    return clip_of(poses, frame_rate=RATE)


def _distance_from_thigh(clip: MotionClip) -> np.ndarray:
    """Return how far the left wrist is from the axis of the left thigh, shape (T,)."""
    positions, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    hip, knee, wrist = (positions[:, joint_index(f"left_{n}")] for n in ("hip", "knee", "middle1"))
    along = (knee - hip) / np.linalg.norm(knee - hip, axis=1, keepdims=True)
    return np.asarray(np.linalg.norm(np.cross(wrist - hip, along), axis=1))


def _shoulder_turns(before: MotionClip, after: MotionClip) -> np.ndarray:
    joint = joint_index("left_shoulder")
    first, second = (Rotation.from_rotvec(clip.poses[:, joint]) for clip in (before, after))
    return np.degrees((first.inv() * second).magnitude())


@given(adduction=st.floats(88, 100), seed=st.integers(0, 99))
@settings(max_examples=20)
def test_a_hand_inside_the_leg_is_moved_out(adduction: float, seed: int) -> None:
    clip = _with_left_arm(np.full(FRAMES, adduction), seed)
    cleared, _ = clear_of_body(clip)
    assert _distance_from_thigh(cleared).min() > min(0.1, _distance_from_thigh(clip).min())
    others = np.delete(np.arange(55), joint_index("left_shoulder"))
    np.testing.assert_array_equal(cleared.poses[:, others], clip.poses[:, others])


def test_a_hand_passing_through_the_body_is_moved_smoothly_and_returns() -> None:
    passing = 60 + 35 * np.exp(-(((np.arange(FRAMES) - 45) / 6) ** 2))
    clip = _with_left_arm(passing)
    cleared, notes = clear_of_body(clip)
    turns = _shoulder_turns(clip, cleared)
    assert turns.max() > 3
    assert turns[[0, 10, -10, -1]].max() < 1e-3
    assert np.abs(np.diff(turns)).max() < 4
    assert "moved out" in notes[0]


@given(adduction=st.floats(-30, 70), seed=st.integers(0, 99))
@settings(max_examples=20)
def test_hands_outside_the_body_are_unchanged(adduction: float, seed: int) -> None:
    clip = _with_left_arm(np.full(8, adduction), seed)
    cleared, notes = clear_of_body(clip)
    assert cleared is clip
    assert notes == ()


def test_recorded_hands_leave_the_thighs_unless_imported_as_recorded(shared_data: Path) -> None:
    path = shared_data / "2_scott_0_1_1.bvh"
    recorded = read_motion(path, frame_rate=15, as_recorded=True)
    assert "moved out" not in recorded.provenance["notes"]
    clip = read_motion(path, frame_rate=15)
    cleared, (note,) = clear_of_body(recorded)
    assert note in clip.provenance["notes"]
    assert int(note.split(" in ")[1].split("%")[0]) <= 10
    np.testing.assert_allclose(cleared.poses, clip.poses, atol=1e-3)
