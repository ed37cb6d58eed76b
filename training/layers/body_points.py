"""Points on the body that motion in 6D puts somewhere, with gradients.

Losses on the body's surface need points that move with every joint and show every turn of it, not
thousands of vertices: each joint carries itself and two points beside it, rigidly.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_COUNT, PARENTS

_BESIDE: Final = 0.05
"""Metres from a joint to the points beside it, about the radius of an arm."""


def _generations() -> list[tuple[list[int], list[int]]]:
    """Return each generation below the root: its joints, and their parents' places in the last."""
    generations, before = [], [0]
    while found := [joint for joint, parent in enumerate(PARENTS) if parent in before]:
        generations.append((found, [before.index(PARENTS[joint]) for joint in found]))
        before = found
    return generations


_GENERATIONS: Final = _generations()

_ORDER: Final = np.argsort([0, *(joint for found, _ in _GENERATIONS for joint in found)]).tolist()
"""Where each joint stands among all generations."""


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
        rows = values[..., : 6 * JOINT_COUNT].reshape(-1, JOINT_COUNT, 2, 3)
        # Frames come last, so that each product of small matrices is one of long rows.
        turns = rotations_of(rows.permute(1, 2, 3, 0))
        world, places = [turns[:1]], [torch.zeros_like(turns[:1, 0])]
        for found, parents in _GENERATIONS:
            before, turn = world[-1][parents], turns[found]
            bones = self.bones[found][:, None, :, None]
            places.append(places[-1][parents] + (before * bones).sum(dim=2))
            terms = [before[:, :, k, None] * turn[:, None, k] for k in range(3)]
            world.append(terms[0] + terms[1] + terms[2])
        joints, axes = torch.cat(places)[_ORDER], _BESIDE * torch.cat(world)[_ORDER]
        beside = joints[:, None] + axes[:, :, :2].transpose(1, 2)
        points = torch.cat([joints, beside.flatten(0, 1)])
        return points.permute(2, 0, 1).reshape(*values.shape[:-1], *points.shape[:2])


def rotations_of(rows: Tensor) -> Tensor:
    """Return rotation matrices (joints, 3, 3, frames) of their first two rows, by Gram-Schmidt.

    Parameters
    ----------
    rows : Tensor
        (joints, 2, 3, frames).
    """
    first = functional.normalize(rows[:, 0], dim=1)
    along = (first * rows[:, 1]).sum(dim=1, keepdim=True)
    second = functional.normalize(rows[:, 1] - along * first, dim=1)
    return torch.stack([first, second, torch.linalg.cross(first, second, dim=1)], dim=1)
