"""Directions of bones and landmarks of the face as tensors; see `bones_and_landmarks`."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

from motion.formats.ted_npz import BONES
from training.spaces.bones_and_landmarks import BONE_LENGTHS, BONE_VALUES


def points_of(values: Tensor) -> Tensor:
    """Return values (…, 3 N) as points (…, N, 3)."""
    return values.reshape(*values.shape[:-1], -1, 3)


def split_motion(values: Tensor) -> dict[str, Tensor]:
    """Return the parts of values (B, T, 27 + 3 L)."""
    pose, face = values[..., :BONE_VALUES], values[..., BONE_VALUES:]
    return {"face": points_of(face), "pose": points_of(pose)}


def joints_of(directions: Tensor) -> Tensor:
    """Return the ten joints (B, T, 10, 3) of directions (B, T, 9, 3), equation 2."""
    units = functional.normalize(directions, dim=-1)
    joints = [torch.zeros_like(units[..., 0, :])] * (len(BONES) + 1)
    for bone, (parent, child) in enumerate(BONES):
        joints[child] = joints[parent] + float(BONE_LENGTHS[bone]) * units[..., bone, :]
    return torch.stack(joints, dim=-2)


def with_units(values: Tensor) -> Tensor:
    """Return values whose directions have length 1 (equation 2)."""
    bones = functional.normalize(points_of(values[:, :BONE_VALUES]), dim=-1)
    return torch.cat([bones.flatten(-2), values[:, BONE_VALUES:]], dim=-1)
