"""Tensors of bones and landmarks hold what the arrays hold."""

from __future__ import annotations

import torch

from training.spaces.bone_tensors import joints_of, split_motion, with_units
from training.spaces.bones_and_landmarks import BONE_LENGTHS
from training.spaces.bones_and_landmarks import joints_of as joints_in_arrays


def test_joints_are_those_of_equation_2() -> None:
    directions = torch.randn(4, 9, 3)
    joints = joints_of(directions)
    wanted = joints_in_arrays(directions.double().numpy())
    torch.testing.assert_close(joints, torch.from_numpy(wanted).float())
    lengths = (joints[:, 5] - joints[:, 4]).norm(dim=-1)
    torch.testing.assert_close(lengths, torch.full((4,), float(BONE_LENGTHS[4])))


def test_motion_is_split_into_nine_bones_and_the_landmarks() -> None:
    values = torch.arange(2 * 3 * 33.0).reshape(2, 3, 33)
    parts = split_motion(values)
    assert parts["pose"].shape == (2, 3, 9, 3)
    torch.testing.assert_close(parts["face"][:, :, 1], values[..., 30:])


def test_directions_get_length_1_and_landmarks_stay() -> None:
    values = torch.randn(4, 33)
    units = with_units(values)
    torch.testing.assert_close(units[:, :27].reshape(4, 9, 3).norm(dim=-1), torch.ones(4, 9))
    torch.testing.assert_close(units[:, 27:], values[:, 27:])
