"""SMPL-X bodies in networks' representations.

AMUSE represents a whole body: 55 joint rotations in 6D, and the translation (Zhou et al. 2019, "On
the Continuity of Rotation Representations in Neural Networks"). A 6D rotation is the first two rows
of its matrix, as in PyTorch3D and AMUSE's release. Losses on the body's surface do not need
thousands of vertices: each joint and two points rigidly attached to it show every rotation, with
gradients.

DiffSHEG represents SHOW's motion: 43 joints, the jaw and 100 expressions.
"""

from typing import Final

import numpy as np
import torch
from scipy.spatial.transform import Rotation
from torch import Tensor, nn
from torch.nn import functional

from motion.arrays import Floats
from motion.body.archive import add_mean_hands
from motion.clip import MotionClip
from motion.placement import place
from motion.skeleton import FINGERS, JOINT_COUNT, PARENTS, RELAXED_HANDS, REST_JOINTS, joint_index

WIDTH: Final = 6 * JOINT_COUNT + 3


def smplx_6d_values(clip: MotionClip) -> Floats:
    """Return a clip's rotations in 6D and its translation in metres, (T, 333)."""
    return np.concatenate([rotation_rows(clip), clip.trans], axis=1)


def rotation_rows(clip: MotionClip) -> Floats:
    """Return the first two rows of each joint's rotation matrix, (T, 330)."""
    matrices = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float)).as_matrix()
    return matrices[:, :2].reshape(len(clip), 6 * JOINT_COUNT)


def smplx_6d_clip(values: Floats, frame_rate: float) -> MotionClip:
    """Return the clip of values in AMUSE's representation.

    Parameters
    ----------
    values : ndarray, shape (T, 333)
        The rows need not be orthonormal: Gram-Schmidt keeps the direction of the first one.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MotionClip
        Placed in the study's world: on the floor at the origin, facing +z.
    """
    frames = len(values)
    rows = values[:, : 6 * JOINT_COUNT].reshape(-1, 2, 3)
    first = _unit(rows[:, 0])
    second = _unit(rows[:, 1] - (first * rows[:, 1]).sum(axis=1, keepdims=True) * first)
    matrices = np.stack([first, second, np.cross(first, second)], axis=1)
    turns = Rotation.from_matrix(matrices).as_rotvec().reshape(frames, JOINT_COUNT, 3)
    clip = MotionClip(
        poses=turns.astype(np.float32),
        trans=values[:, 6 * JOINT_COUNT :].astype(np.float32),
        frame_rate=frame_rate,
    )
    return place(clip)[0]


def _unit(vectors: Floats) -> Floats:
    lengths: Floats = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.maximum(lengths, np.finfo(np.float64).tiny)


TRUNK_AND_ARM_JOINTS: Final = (
    "spine1", "spine2", "spine3", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
)  # fmt: skip
"""The first 13 joints, in SMPL-X's order; the 30 joints of the hands follow."""

UPPER_BODY_JOINTS: Final = (
    *(joint_index(name) for name in TRUNK_AND_ARM_JOINTS),
    *range(FINGERS.start, FINGERS.stop),
)
_BODY: Final = 3 * len(UPPER_BODY_JOINTS)
_JAW: Final = slice(_BODY, _BODY + 3)


def show_values(clip: MotionClip) -> Floats:
    """Return DiffSHEG's values of a clip whose fingers are relative to SMPL-X's mean hands.

    Returns
    -------
    ndarray, shape (T, 232)
        Rotations, axis-angle in radians; jaw; expression coefficients, 0 if the clip has none.
    """
    frames = len(clip)
    expressions = np.zeros((frames, 100)) if clip.expressions is None else clip.expressions
    body = clip.poses[:, list(UPPER_BODY_JOINTS)].reshape(frames, _BODY)
    jaw = clip.poses[:, joint_index("jaw")]
    return np.concatenate([body, jaw, expressions], axis=1, dtype=np.float64)


def show_clip(values: Floats, frame_rate: float) -> MotionClip:
    """Return DiffSHEG's motion as a clip.

    SHOW's fingers are relative to SMPL-X's mean hands, which only a licensed model has; relaxed
    hands take their place.

    Parameters
    ----------
    values : ndarray, shape (T, 232)
        See `show_values`.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MotionClip
        Standing on the floor at the origin, facing +z; hips and legs stand still.
    """
    frames = len(values)
    poses = np.zeros((frames, JOINT_COUNT, 3))
    poses[:, list(UPPER_BODY_JOINTS)] = values[:, :_BODY].reshape(frames, len(UPPER_BODY_JOINTS), 3)
    poses[:, joint_index("jaw")] = values[:, _JAW]
    clip = MotionClip(
        poses=poses.astype(np.float32),
        trans=np.zeros((frames, 3), np.float32),
        frame_rate=frame_rate,
        expressions=values[:, _JAW.stop :].astype(np.float32),
    )
    return place(add_mean_hands(clip, RELAXED_HANDS))[0]


_AXIS_LENGTH: Final = 0.05
"""Distance from a joint to the points around it in metres, about the radius of an arm."""


def _generations() -> list[tuple[list[int], list[int]]]:
    """Return each generation's joints, and their parents' indices in the previous generation."""
    generations, previous = [], [0]
    while joints := [joint for joint, parent in enumerate(PARENTS) if parent in previous]:
        generations.append((joints, [previous.index(PARENTS[joint]) for joint in joints]))
        previous = joints
    return generations


_GENERATIONS: Final = _generations()

_ORDER: Final = np.argsort([0, *(joint for joints, _ in _GENERATIONS for joint in joints)]).tolist()
"""Each joint's position in the order of generations."""


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
        """Return points relative to the pelvis, in metres.

        Parameters
        ----------
        values : Tensor
            (…, 333), see `training.spaces.smplx_bodies`; the translation is ignored.

        Returns
        -------
        Tensor
            (…, 165, 3): each joint, and the points 5 cm along its x and y axis.
        """
        rows = values[..., : 6 * JOINT_COUNT].reshape(-1, JOINT_COUNT, 2, 3)
        # Frames come last, so that products of small matrices are products of long rows.
        turns = matrices_from_rows(rows.permute(1, 2, 3, 0))
        world, places = [turns[:1]], [torch.zeros_like(turns[:1, 0])]
        for joints_of_generation, parents in _GENERATIONS:
            parent_turns, turn = world[-1][parents], turns[joints_of_generation]
            bones = self.bones[joints_of_generation][:, None, :, None]
            places.append(places[-1][parents] + (parent_turns * bones).sum(dim=2))
            terms = [parent_turns[:, :, k, None] * turn[:, None, k] for k in range(3)]
            world.append(terms[0] + terms[1] + terms[2])
        joints, axes = torch.cat(places)[_ORDER], _AXIS_LENGTH * torch.cat(world)[_ORDER]
        axis_points = joints[:, None] + axes[:, :, :2].transpose(1, 2)
        points = torch.cat([joints, axis_points.flatten(0, 1)])
        return points.permute(2, 0, 1).reshape(*values.shape[:-1], *points.shape[:2])


def matrices_from_rows(rows: Tensor) -> Tensor:
    """Return rotation matrices (joints, 3, 3, frames) from their first two rows, by Gram-Schmidt.

    Parameters
    ----------
    rows : Tensor
        (joints, 2, 3, frames).
    """
    first = functional.normalize(rows[:, 0], dim=1)
    overlap = (first * rows[:, 1]).sum(dim=1, keepdim=True)
    second = functional.normalize(rows[:, 1] - overlap * first, dim=1)
    return torch.stack([first, second, torch.linalg.cross(first, second, dim=1)], dim=1)
