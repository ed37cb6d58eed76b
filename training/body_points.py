"""Points on the body that motion in 6D puts somewhere, with gradients.

Losses on the body's surface need points that move with every joint and show every turn of it, not
thousands of vertices: each joint carries itself and two points beside it, rigidly.
"""

from __future__ import annotations

from typing import Final

import torch
from torch import Tensor, nn
from torch.nn import functional

from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_COUNT, PARENTS

_BESIDE: Final = 0.05
"""Metres from a joint to the points beside it, about the radius of an arm."""


class BodyPoints(nn.Module):
    """Forward kinematics of the default body (SMPL-X's skeleton), without a mesh."""

    bones: Tensor

    def __init__(self) -> None:
        super().__init__()
        rest = torch.tensor(REST_JOINTS, dtype=torch.float32)
        parents = torch.tensor([max(parent, 0) for parent in PARENTS])
        bones = rest - rest[parents]
        bones[0] = 0
        self.register_buffer("bones", bones, persistent=False)

    def forward(self, values: Tensor) -> Tensor:
        """Return points against the pelvis, metres.

        Parameters
        ----------
        values : Tensor
            (…, 333), see `training.spaces.smplx_6d`; the translation moves no point.

        Returns
        -------
        Tensor
            (…, 165, 3): each joint, and the points 5 cm along its x and y axis.
        """
        turns = rotations_of(
            values[..., : 6 * JOINT_COUNT].reshape(*values.shape[:-1], JOINT_COUNT, 6)
        )
        world = [turns[..., 0, :, :]]
        places = [torch.zeros_like(world[0][..., 0])]
        for joint in range(1, JOINT_COUNT):
            parent = PARENTS[joint]
            places.append(places[parent] + world[parent] @ self.bones[joint])
            world.append(world[parent] @ turns[..., joint, :, :])
        joints = torch.stack(places, dim=-2)
        axes = _BESIDE * torch.stack(world, dim=-3)
        beside = joints[..., None, :] + axes[..., :2].transpose(-1, -2)
        return torch.cat([joints, beside.flatten(-3, -2)], dim=-2)


def rotations_of(rows: Tensor) -> Tensor:
    """Return rotation matrices (…, 3, 3) of their first two rows (…, 6), by Gram-Schmidt."""
    first = functional.normalize(rows[..., :3], dim=-1)
    along = (first * rows[..., 3:]).sum(dim=-1, keepdim=True)
    second = functional.normalize(rows[..., 3:] - along * first, dim=-1)
    return torch.stack([first, second, torch.linalg.cross(first, second)], dim=-2)
