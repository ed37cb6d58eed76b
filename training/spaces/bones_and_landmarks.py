"""Speech2UnifiedExpressions' motion: directions of bones, and landmarks of the face.

Bhattacharya et al. 2024, sections 3.1 and 3.2. A frame is nine unit vectors along the bones of ten
joints of the upper body, then the shift of each facial landmark from its position in the neutral
face, in metres. Both are seen from the front: the body relative to the direction of its hips, the
face relative to the head.
"""

from dataclasses import replace
from typing import Final

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from motion.arrays import Floats
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.ted_npz import BONES, JOINT_NAMES, chain_bones
from motion.points.joint_rotations import clip_from_joints
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index

BONE_VALUES: Final = 3 * len(BONES)

_PARENTS, _CHILDREN = np.array(BONES).T
_JOINTS: Final = [joint_index(name) for name in JOINT_NAMES]
_BONES: Final = REST_JOINTS[_JOINTS][_CHILDREN] - REST_JOINTS[_JOINTS][_PARENTS]

BONE_LENGTHS: Final[Floats] = np.linalg.norm(_BONES, axis=1)
"""Lengths of the default body's bones in metres."""


def bone_and_landmark_values(clip: MotionClip, face: FaceLandmarks | None) -> Floats:
    """Return directions of bones and shifts of landmarks, (T, 27 + 3 L); no shifts without `face`.

    Raises
    ------
    InputError
        If the clip's face is in terms that the landmarks' body does not show.
    """
    joints = forward_kinematics(clip.poses, np.zeros_like(clip.trans), REST_JOINTS)[0]
    directions = bone_directions(facing_forward(joints)[:, _JOINTS])
    shifts = np.zeros((len(clip), 0)) if face is None else face.shifts(clip)
    return np.concatenate(
        [directions.reshape(len(clip), -1), shifts.reshape(len(clip), -1)], axis=1
    )


def bone_and_landmark_clip(values: Floats, frame_rate: float, face: FaceLandmarks) -> MotionClip:
    """Return values (T, 27 + 3 L) as a clip of the landmarks' body.

    Its bones have the given directions, and its facial actions fit the shifts of the landmarks.
    """
    directions, shifts = np.split(values, [BONE_VALUES], axis=1)
    joints = joints_from_directions(directions.reshape(len(values), -1, 3)).astype(np.float32)
    points = zip(JOINT_NAMES, np.moveaxis(joints.astype(np.float64), 1, 0), strict=True)
    clip = clip_from_joints(dict(points), face.body.joints(np.zeros(0)), frame_rate)
    landmarks = shifts.reshape(len(values), -1, 3).astype(np.float32)
    return replace(clip, arkit=face.facial_actions(landmarks))


def facing_forward(joints: Floats) -> Floats:
    """Return SMPL-X joints (T, 55, 3) relative to the pelvis, turned so that the hips face +z.

    Each frame is turned only about the vertical, so leaning is kept. Among such turns, it is the
    least-squares fit of the hips to the unposed body's (Umeyama 1991).
    """
    across = joints[:, joint_index("left_hip")] - joints[:, joint_index("right_hip")]
    length = np.maximum(np.hypot(across[:, 0], across[:, 2]), np.finfo(np.float64).tiny)
    cos, sin = across[:, 0] / length, across[:, 2] / length
    x, y, z = np.moveaxis(joints - joints[:, :1], -1, 0)
    cos, sin = cos[:, None], sin[:, None]
    return np.stack([cos * x + sin * z, y, cos * z - sin * x], axis=-1)


def bone_directions(joints: Floats) -> Floats:
    """Return unit vectors along the bones (T, 9, 3) of the ten joints (T, 10, 3)."""
    offsets = joints[:, _CHILDREN] - joints[:, _PARENTS]
    lengths = np.linalg.norm(offsets, axis=-1, keepdims=True)
    if not lengths.all():
        raise InputError("a bone has no length", remedy="Repair the recording")
    return np.asarray(offsets / lengths)


def joints_from_directions(directions: Floats, lengths: Floats = BONE_LENGTHS) -> Floats:
    """Return the ten joints (T, 10, 3) relative to the pelvis; directions are normalised first."""
    units = directions / np.maximum(np.linalg.norm(directions, axis=-1, keepdims=True), 1e-9)
    return chain_bones(lengths[:, None] * units)


def as_points(values: Tensor) -> Tensor:
    """Return values (…, 3 N) as points (…, N, 3)."""
    return values.reshape(*values.shape[:-1], -1, 3)


def split_motion(values: Tensor) -> dict[str, Tensor]:
    """Return the parts of values (B, T, 27 + 3 L)."""
    pose, face = values[..., :BONE_VALUES], values[..., BONE_VALUES:]
    return {"face": as_points(face), "pose": as_points(pose)}


def joint_tensors(directions: Tensor) -> Tensor:
    """Return the ten joints (B, T, 10, 3) from directions (B, T, 9, 3), equation 2."""
    units = functional.normalize(directions, dim=-1)
    joints = [torch.zeros_like(units[..., 0, :])] * (len(BONES) + 1)
    for bone, (parent, child) in enumerate(BONES):
        joints[child] = joints[parent] + float(BONE_LENGTHS[bone]) * units[..., bone, :]
    return torch.stack(joints, dim=-2)


def with_units(values: Tensor) -> Tensor:
    """Return values with directions normalised to length 1 (equation 2)."""
    bones = functional.normalize(as_points(values[:, :BONE_VALUES]), dim=-1)
    return torch.cat([bones.flatten(-2), values[:, BONE_VALUES:]], dim=-1)
