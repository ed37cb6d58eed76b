"""Clips become directions and landmarks, and clips again."""

from __future__ import annotations

import numpy as np
import torch
from scipy.spatial.transform import Rotation

from motion.body.face_landmarks import FaceLandmarks
from motion.clip import ARKIT_NAMES, MotionClip
from motion.formats.ted_npz import BONES, JOINT_NAMES
from motion.skeleton import JOINT_COUNT, REST_JOINTS, forward_kinematics, joint_index
from training.spaces.bones_and_landmarks import (
    BONE_LENGTHS,
    BONE_VALUES,
    bone_and_landmark_clip,
    bone_and_landmark_values,
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


def test_directions_from_the_front_are_units_from_which_joints_are_built_again() -> None:
    values = bone_and_landmark_values(clip(), FACE)
    assert values.shape == (5, BONE_VALUES + 3 * FACE.count)
    np.testing.assert_allclose(values[0, BONE_VALUES:], 0, atol=1e-7)
    again = bone_and_landmark_values(bone_and_landmark_clip(values, 15.0, FACE), FACE)
    arms = np.arange(BONE_VALUES).reshape(-1, 3)[[4, 5, 7, 8]].ravel()
    np.testing.assert_allclose(again[:, arms], values[:, arms], atol=0.02)
    np.testing.assert_allclose(again[:, BONE_VALUES:], values[:, BONE_VALUES:], atol=2e-3)
    directions = values[:, :BONE_VALUES].reshape(5, len(BONES), 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1)
    joints = forward_kinematics(clip().poses, np.zeros((5, 3)), REST_JOINTS)[0]
    expected = joints[:, [joint_index(name) for name in JOINT_NAMES]] - joints[:, :1]
    np.testing.assert_allclose(joints_from_directions(directions), expected, atol=1e-6)
    np.testing.assert_allclose(joints_from_directions(3 * directions), expected, atol=1e-6)
    np.testing.assert_allclose(BONE_LENGTHS[4:6], [0.2713, 0.2522], atol=1e-4)
    tensors = joint_tensors(torch.from_numpy(3 * directions)).numpy()
    np.testing.assert_allclose(tensors, expected, atol=1e-6)
    stretched = torch.from_numpy(values * np.repeat([3, 1], [BONE_VALUES, 3 * FACE.count]))
    np.testing.assert_allclose(with_units(stretched).numpy(), values, atol=1e-6)
    turned = bone_and_landmark_values(clip(2.0), FACE)
    np.testing.assert_allclose(turned, values, atol=1e-6)
