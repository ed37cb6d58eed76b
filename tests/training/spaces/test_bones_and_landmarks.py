"""Clips become directions and landmarks, and clips again."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from motion.body.face_landmarks import FaceLandmarks
from motion.clip import ARKIT_NAMES, MotionClip
from motion.errors import InputError
from motion.formats.ted_npz import BONES, JOINT_NAMES
from motion.points.clip_from_points import clip_from_points
from motion.skeleton import JOINT_COUNT, REST_JOINTS, forward_kinematics, joint_index
from training.spaces.bones_and_landmarks import (
    BONE_LENGTHS,
    BONE_VALUES,
    bone_and_landmark_values,
    bone_directions,
    joint_tensors,
    joints_from_directions,
    with_units,
)

FACE = FaceLandmarks.of_default_body()


def clip(turned: float = 0.0) -> MotionClip:
    poses = np.zeros((5, JOINT_COUNT, 3), np.float32)
    poses[:, joint_index("left_shoulder")] = [0, 0, -1.0]
    poses[:, joint_index("right_elbow"), 1] = np.linspace(0.5, 1.5, 5)
    poses[:, 0] = (Rotation.from_euler("y", turned)).as_rotvec()
    arkit = np.zeros((5, 52), np.float32)
    arkit[:, ARKIT_NAMES.index("jawOpen")] = np.linspace(0, 0.8, 5)
    return MotionClip(poses=poses, trans=np.ones((5, 3), np.float32), frame_rate=15, arkit=arkit)


def test_directions_are_units_from_which_joints_are_built_again() -> None:
    values = bone_and_landmark_values(clip(), FACE)
    assert values.shape == (5, BONE_VALUES + 3 * FACE.count)
    directions = values[:, :BONE_VALUES].reshape(5, len(BONES), 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1)
    joints = forward_kinematics(clip().poses, np.zeros((5, 3)), REST_JOINTS)[0]
    expected = joints[:, [joint_index(name) for name in JOINT_NAMES]] - joints[:, :1]
    np.testing.assert_allclose(joints_from_directions(directions), expected, atol=1e-6)
    np.testing.assert_allclose(joints_from_directions(3 * directions), expected, atol=1e-6)
    np.testing.assert_allclose(BONE_LENGTHS[4:6], [0.2713, 0.2522], atol=1e-4)


def test_it_is_seen_from_the_front_for_any_heading() -> None:
    np.testing.assert_allclose(
        bone_and_landmark_values(clip(2.0), FACE), bone_and_landmark_values(clip(), FACE), atol=1e-6
    )


def test_landmarks_are_shifts_from_the_neutral_face() -> None:
    shifts = bone_and_landmark_values(clip(), FACE)[:, BONE_VALUES:]
    np.testing.assert_allclose(shifts[0], 0, atol=1e-7)
    np.testing.assert_allclose(shifts, FACE.shifts(clip()).reshape(5, -1), atol=1e-7)
    assert bone_and_landmark_values(clip(), None).shape == (5, BONE_VALUES)


def test_the_clip_of_values_has_the_same_values() -> None:
    values = bone_and_landmark_values(clip(), FACE)
    again = clip_from_points(
        joints_from_directions(values[:, :BONE_VALUES].reshape(5, -1, 3)).astype(np.float32),
        JOINT_NAMES,
        15.0,
        body=FACE.body,
        landmarks=values[:, BONE_VALUES:].reshape(5, -1, 3).astype(np.float32),
    )
    result = bone_and_landmark_values(again, FACE)
    arms = np.arange(BONE_VALUES).reshape(-1, 3)[[4, 5, 7, 8]].ravel()
    np.testing.assert_allclose(result[:, arms], values[:, arms], atol=0.02)
    np.testing.assert_allclose(result[:, BONE_VALUES:], values[:, BONE_VALUES:], atol=2e-3)


def test_a_bone_without_length_is_refused() -> None:
    with pytest.raises(InputError, match="no length"):
        bone_directions(np.zeros((1, 10, 3)))


def test_joints_are_those_of_equation_2() -> None:
    directions = torch.randn(4, 9, 3)
    joints = joint_tensors(directions)
    expected = joints_from_directions(directions.double().numpy())
    torch.testing.assert_close(joints, torch.from_numpy(expected).float())
    lengths = (joints[:, 5] - joints[:, 4]).norm(dim=-1)
    torch.testing.assert_close(lengths, torch.full((4,), float(BONE_LENGTHS[4])))


def test_directions_get_length_1_and_landmarks_stay() -> None:
    values = torch.randn(4, 33)
    units = with_units(values)
    torch.testing.assert_close(units[:, :27].reshape(4, 9, 3).norm(dim=-1), torch.ones(4, 9))
    torch.testing.assert_close(units[:, 27:], values[:, 27:])
