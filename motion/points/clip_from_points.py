"""A motion clip from positions of joints and landmarks, as position-based systems give them.

The bones of the body take the directions of the joints. How landmarks of a face shift becomes the
facial actions that shift them so.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import BodyModel
from motion.clip import ARKIT_COUNT, MotionClip
from motion.errors import InputError
from motion.points.joint_rotations import (
    REQUIRED_JOINTS,
    check_directions,
    given_bones,
    rotations_from_joints,
)
from motion.skeleton import JOINT_NAMES, joint_index

FloatArray = NDArray[np.float32]

_LARGEST_SHIFT: Final = 0.2
"""Largest shift of a face's landmark, in metres."""

EXACT: Final = 3e-4
"""Metres of misfit that count as much as a weight of 1, of landmarks without noise: only what no
landmark shows stays 0."""

_MAX_SWEEPS: Final = 200
_TOLERANCE: Final = 1e-4
"""A sweep that changes no weight by more ends the search."""

_MAX_SIZE_RATIO: Final = 2.5
"""Largest plausible ratio of a person's bone lengths to the body's, or its inverse."""


def facial_actions(shifts: FloatArray, body: BodyModel, *, misfit: float = EXACT) -> FloatArray:
    """Return the weights of ARKit's facial actions that shift the landmarks nearest to `shifts`.

    Least squares with all weights in [0, 1], by coordinate descent in all frames at once.

    Parameters
    ----------
    shifts : ndarray, shape (T, L, 3)
        From the neutral face, in the head's frame, metres, in the order of
        `FaceLandmarks.of(body)`.
    body : BodyModel
        The body whose facial actions they are.
    misfit : float
        Metres of misfit, over all landmarks, that count as much as a weight of 1. Noisy landmarks
        need more, so that no action explains their noise.

    Returns
    -------
    ndarray, shape (T, 52), float32

    Raises
    ------
    InputError
        If the body shows no facial actions, or the landmarks are not as stated.
    """
    if not body.has_arkit_slots:
        raise InputError(
            "the body shows no ARKit facial actions, which landmarks are converted to",
            remedy="Name an avatar instead of this body under [video] in study.toml",
        )
    landmarks = FaceLandmarks.of(body)
    _check_shifts(shifts, landmarks.count)
    directions = landmarks.body.expression_directions[: landmarks.count]
    slots = min(directions.shape[2], ARKIT_COUNT)
    effects = directions[:, :, :slots].reshape(-1, slots).astype(np.float64)
    flat = shifts.reshape(len(shifts), -1).astype(np.float64)
    weights = np.zeros((len(shifts), ARKIT_COUNT), np.float32)
    weights[:, :slots] = _bounded(effects, flat, misfit).T
    return weights


def _bounded(
    effects: NDArray[np.float64], targets: NDArray[np.float64], misfit: float
) -> NDArray[np.float64]:
    """Return the weights (K, T) in [0, 1] by which `effects` (P, K) come nearest to `targets`."""
    normal = effects.T @ effects + misfit**2 * np.eye(effects.shape[1])
    projections = effects.T @ targets.T
    weights = np.clip(np.linalg.solve(normal, projections), 0, 1)
    for _ in range(_MAX_SWEEPS):
        previous = weights.copy()
        for k, row in enumerate(normal):
            residual = projections[k] - row @ weights
            weights[k] = np.clip(weights[k] + residual / row[k], 0, 1)
        if np.abs(weights - previous).max() < _TOLERANCE:
            break
    return np.asarray(weights)


def _check_shifts(shifts: FloatArray, count: int) -> None:
    if shifts.ndim != 3 or shifts.shape[1:] != (count, 3):
        raise InputError(
            f"the landmarks have shape {shifts.shape}",
            remedy=f"Give (frames, {count}, 3): the landmarks that FaceLandmarks.of(body) chooses",
        )
    if not np.isfinite(shifts).all():
        frame, landmark = map(int, np.argwhere(~np.isfinite(shifts))[0, :2])
        raise InputError(
            f"landmark {landmark} is not a number in frame {frame}",
            remedy="Fill the gap or leave the frame out",
        )
    farthest = float(np.linalg.norm(shifts, axis=2).max(initial=0))
    if farthest > _LARGEST_SHIFT:
        raise InputError(
            f"a landmark shifts by {farthest:.3g} m, farther than any face moves",
            remedy="Give metres, as shifts from the neutral face while the head is held still",
        )


def clip_from_points(
    joints: FloatArray,
    names: tuple[str, ...],
    frame_rate: float,
    *,
    body: BodyModel,
    landmarks: FloatArray | None = None,
) -> MotionClip:
    """Return the clip that moves a body's bones and face to given points.

    Parameters
    ----------
    joints : ndarray, shape (T, J, 3)
        Positions in metres, y up. Only directions count: the body keeps its own lengths.
    names : tuple of str
        Their SMPL-X names, in any order: at least pelvis, neck and both shoulders. Missing parts
        stay at rest: relaxed hands, arms down, standing legs.
    frame_rate : float
        Frames per second.
    body : BodyModel
        The body that will show the clip.
    landmarks : ndarray, shape (T, L, 3), optional
        How far the landmarks of `motion.body.face_landmarks.FaceLandmarks.of(body)` shift from the
        neutral face in the head's frame, metres. They become facial actions.

    Raises
    ------
    InputError
        If joints are missing, unknown or without number or direction, not in metres, or the
        landmarks are not those of the body.
    """
    points = _checked(joints, names)
    rest = body.joints(np.zeros(0))
    check_directions(points)
    _check_size(points, rest)
    if landmarks is not None and len(landmarks) != len(joints):
        raise InputError(
            f"there are {len(landmarks)} frames of landmarks and {len(joints)} of joints",
            remedy="Give both for the same frames",
        )
    poses, trans = rotations_from_joints(points, rest, frame_rate)
    return MotionClip(
        poses=poses.astype(np.float32),
        trans=trans.astype(np.float32),
        frame_rate=frame_rate,
        arkit=None if landmarks is None else facial_actions(landmarks, body),
    )


def _checked(joints: FloatArray, names: tuple[str, ...]) -> dict[str, NDArray[np.float64]]:
    """Return the positions of joints, shape (T, 3) each."""
    if joints.ndim != 3 or joints.shape[1:] != (len(names), 3) or not len(joints):
        raise InputError(
            f"the joints have shape {joints.shape}, with {len(names)} names",
            remedy=f"Give (frames, {len(names)}, 3), at least one frame",
        )
    unknown = [name for name in names if name not in JOINT_NAMES]
    if unknown or len(set(names)) < len(names):
        problem = f"unknown joint {unknown[0]!r}" if unknown else "a joint is named twice"
        raise InputError(problem, remedy=f"Use SMPL-X's names: {', '.join(JOINT_NAMES[:22])}, …")
    missing = [name for name in REQUIRED_JOINTS if name not in names]
    if missing:
        raise InputError(
            f"the joints lack {', '.join(missing)}",
            remedy=f"Give at least {', '.join(REQUIRED_JOINTS)}",
        )
    if not np.isfinite(joints).all():
        frame, joint = map(int, np.argwhere(~np.isfinite(joints))[0, :2])
        raise InputError(
            f"{names[joint]} is not a number in frame {frame}",
            remedy="Fill the gap or leave the frame out",
        )
    return {name: joints[:, index].astype(np.float64) for index, name in enumerate(names)}


def _check_size(points: Mapping[str, NDArray[np.float64]], rest: NDArray[np.float64]) -> None:
    """Raise `InputError` unless the figure has the size of a person in metres."""
    ratios = []
    for start, end in given_bones(points):
        length = np.median(np.linalg.norm(points[end] - points[start], axis=1))
        rest_length = np.linalg.norm(rest[joint_index(end)] - rest[joint_index(start)])
        ratios.append(float(length) / float(rest_length))
    size = float(np.median(ratios))
    if not 1 / _MAX_SIZE_RATIO < size < _MAX_SIZE_RATIO:
        raise InputError(
            f"the bones are {size:.3g} times as long as the body's",
            remedy="Give metres",
        )
