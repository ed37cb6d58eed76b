from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.clearance import clear_of_body
from motion.clip import MotionClip
from motion.formats import read_motion
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import clip_of

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
    distances = _distance_from_thigh(clip)
    positions, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    low = positions[:, joint_index("left_middle1"), 1] < positions[:, joint_index("left_hip"), 1]
    high = positions[:, joint_index("left_middle1"), 1] > positions[:, joint_index("left_knee"), 1]
    assert distances[low & high].min() > 0.085
