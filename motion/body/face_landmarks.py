"""Landmarks of the face: a few vertices of a body, and how a clip moves them.

A landmark belongs to one facial action or expression component, as those of
Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 3.3.2) are based on action units. All
clips use the body's mean shape and the head's frame of reference, so that landmarks of different
speakers are comparable.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from motion.arrays import Bools, Floats, Floats32, Ints
from motion.body.model import BodyModel
from motion.clip import ARKIT_COUNT, ARKIT_NAMES, MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_COUNT, joint_index

_COMPONENTS: Final = 52
"""Number of facial actions, or leading expression components, that may have a landmark."""

_MIN_DISTANCE: Final = 0.006
"""Smallest distance between two landmarks of the neutral face, in metres."""

_MIN_SHIFT: Final = 1e-3
"""Smallest movement of a landmark by its component, in metres."""

_SKIN: Final = ("skin", "lips")
"""Materials that may have landmarks, if the body names the materials of its vertices."""

_EXACT: Final = 3e-4
"""Metres of misfit that count as much as a weight of 1, for landmarks without noise: only actions
that no landmark shows stay 0."""

_MAX_SWEEPS: Final = 200
_TOLERANCE: Final = 1e-4
"""A sweep that changes no weight by more ends the search."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceLandmarks:
    """Landmarks on one face.

    Attributes
    ----------
    body : BodyModel
        A body of landmarks and joints only; its first vertices are the landmarks.
    count : int
        The number of landmarks.
    """

    body: BodyModel
    count: int

    @classmethod
    def of(cls, body: BodyModel) -> FaceLandmarks:
        """Choose landmarks on the face of `body`.

        For each component in turn, takes the vertex that it moves most among those at least 6 mm
        from all earlier landmarks, if it moves that vertex by 1 mm or more.

        Raises
        ------
        InputError
            If the body has no face that moves.
        """
        vertices = landmark_vertices(body)
        if not len(vertices):
            raise InputError(
                "the body has no face that moves",
                remedy="Name an avatar with a face, or an SMPL-X body, under [video] in study.toml",
            )
        return cls.from_arrays(_arrays_of(body, vertices))

    @classmethod
    def of_default_body(cls) -> FaceLandmarks:
        """Return the landmarks of the default body.

        Taken from the body that `renderer.look` names (a test compares the two), so that networks
        need no mesh.
        """
        with np.load(Path(__file__).with_name("default_face.npz")) as file:
            return cls.from_arrays(dict(file))

    @cached_property
    def actions(self) -> tuple[str, ...]:
        """The facial action that each landmark belongs to."""
        return tuple(ARKIT_NAMES[component] for component, _ in _choose_landmarks(self.body))

    def facial_actions(self, shifts: Floats32, *, misfit: float = _EXACT) -> Floats32:
        """Return the weights of ARKit's facial actions that best explain the landmarks' shifts.

        Least squares with all weights in [0, 1], by coordinate descent in all frames at once.

        Parameters
        ----------
        shifts : ndarray, shape (T, L, 3)
            Shifts in metres, as the method `shifts` returns them.
        misfit : float
            Metres of misfit, over all landmarks, that count as much as a weight of 1. Noisy
            landmarks need more, so that no action explains their noise.

        Returns
        -------
        ndarray, shape (T, 52), float32
        """
        directions = self.body.expression_directions[: self.count]
        slots = min(directions.shape[2], ARKIT_COUNT)
        effects = directions[:, :, :slots].reshape(-1, slots).astype(np.float64)
        flat = shifts.reshape(len(shifts), -1).astype(np.float64)
        weights = np.zeros((len(shifts), ARKIT_COUNT), np.float32)
        weights[:, :slots] = _bounded_weights(effects, flat, misfit).T
        return weights

    def shifts(self, clip: MotionClip) -> Floats32:
        """Return the shifts of the landmarks from the neutral face.

        Parameters
        ----------
        clip : MotionClip
            The motion; only its face and jaw count.

        Returns
        -------
        ndarray, shape (T, L, 3), float32
            Metres.

        Raises
        ------
        InputError
            If the clip's face is in terms that the body does not show.
        """
        return np.asarray(self.positions(clip) - self.neutral)

    def positions(self, clip: MotionClip) -> Floats32:
        """Return the landmarks' positions with a still head, shape (T, L, 3), in metres.

        Raises
        ------
        InputError
            If the clip's face is in terms that the body does not show.
        """
        if self.body.face(clip) is None:
            units = "ARKit weights" if self.body.has_arkit_slots else "expression coefficients"
            raise InputError(
                f"the clip has no face in the units of the landmarks' body, {units}",
                remedy="Use clips that do, or name an expression matrix under [video]",
            )
        poses = np.zeros_like(clip.poses)
        jaw = joint_index("jaw")
        poses[:, jaw] = clip.poses[:, jaw]
        faces = replace(
            clip, poses=poses, trans=np.zeros_like(clip.trans), betas=np.zeros(0, np.float32)
        )
        # All frames at once: the body's own batches are sized for many more vertices.
        unposed = self.body.unposed(faces)[:, : self.count]
        moved_by = np.tensordot(self.body.skinning_matrices(faces), self._weights, axes=(1, 1))
        rotated = np.einsum("nabv,nvb->nva", moved_by[:, :, :3], unposed)
        return np.asarray(rotated + np.swapaxes(moved_by[:, :, 3], 1, 2), np.float32)

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return the landmarks as arrays, which `from_arrays` reads back."""
        body = self.body
        arrays: dict[str, NDArray[np.generic]] = {
            "template": body.template,
            "expression_directions": body.expression_directions,
            "weights": body.weights.toarray(),
            "arkit_slots": np.array([body.has_arkit_slots], np.uint8),
        }
        if body.pose_directions is not None:
            arrays["pose_directions"] = body.pose_directions
        if body.expression_matrix is not None:
            arrays["expression_matrix"] = body.expression_matrix
        return arrays

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> FaceLandmarks:
        """Return the landmarks from what their `arrays` returned.

        Raises
        ------
        InputError
            If an array is missing, or their shapes do not fit together.
        """
        try:
            template = arrays["template"]
            directions = arrays["expression_directions"]
            weights = arrays["weights"]
            slots = arrays["arkit_slots"]
        except KeyError as error:
            raise InputError(f"the landmarks lack {error}", remedy="Make the file again") from error
        rows = len(template)
        pose, matrix = arrays.get("pose_directions"), arrays.get("expression_matrix")
        count = rows - JOINT_COUNT
        joints = sparse.eye_array(JOINT_COUNT, rows, k=count, format="csr", dtype=np.float32)
        body = BodyModel(
            template=template,
            faces=np.zeros((0, 3), np.int64),
            shape_directions=np.zeros((rows, 3, 0), np.float32),
            expression_directions=directions,
            pose_directions=pose,
            joint_regressor=sparse.csr_array(joints),
            weights=sparse.csr_array(weights),
            expression_matrix=matrix,
            has_arkit_slots=bool(slots[0]),
        )
        return cls(body=body, count=count)

    @cached_property
    def _weights(self) -> Floats32:
        """Skin weights of the landmarks, shape (L, 55)."""
        return np.asarray(self.body.weights[: self.count].toarray(), np.float32)

    @cached_property
    def neutral(self) -> Floats32:
        """Positions of the landmarks in the neutral face, shape (L, 3), in metres."""
        return self.body.template[: self.count]


def landmark_vertices(body: BodyModel) -> Ints:
    """Return the vertices of `body` that `FaceLandmarks.of` chooses, in the order of components."""
    return np.array([vertex for _, vertex in _choose_landmarks(body)], np.int64)


def _choose_landmarks(body: BodyModel) -> list[tuple[int, int]]:
    """Return each component that has a landmark, with the landmark's vertex."""
    displacements = np.linalg.norm(body.expression_directions, axis=1)
    allowed = _skin_mask(body)
    chosen: list[tuple[int, int]] = []
    for component in range(min(_COMPONENTS, displacements.shape[1])):
        candidates = np.where(allowed, displacements[:, component], 0)
        vertex = int(candidates.argmax())
        if candidates[vertex] < _MIN_SHIFT:
            continue
        chosen.append((component, vertex))
        distances = np.linalg.norm(body.template - body.template[vertex], axis=1)
        allowed &= distances >= _MIN_DISTANCE
    return chosen


def _skin_mask(body: BodyModel) -> Bools:
    """Return whether each vertex may be a landmark."""
    if "material" not in body.surface:
        return np.ones(len(body.template), bool)
    names = [str(name) for name in body.surface["material_names"]]
    materials = [names.index(name) for name in _SKIN if name in names]
    return np.isin(body.surface["material"], materials)


def _arrays_of(body: BodyModel, vertices: Ints) -> dict[str, NDArray[Any]]:
    """Return the arrays of a body whose vertices are `vertices` of `body`, then its joints.

    Joints are weighted sums of vertices, and move with expressions as these sums do.
    """
    regressor = body.joint_regressor

    def reduced(values: Floats32) -> Floats32:
        flat = (regressor @ values.reshape(len(values), -1)).reshape(JOINT_COUNT, *values.shape[1:])
        return np.concatenate([values[vertices], flat.astype(np.float32)])

    weights = body.weights[vertices].toarray()[:, :JOINT_COUNT]
    arrays: dict[str, NDArray[Any]] = {
        "template": reduced(body.template),
        "expression_directions": reduced(body.expression_directions),
        "weights": np.concatenate([weights, np.eye(JOINT_COUNT, dtype=np.float32)]),
        "arkit_slots": np.array([body.has_arkit_slots]),
    }
    pose = body.pose_directions
    if pose is not None:
        zero_directions = np.zeros((JOINT_COUNT, *pose.shape[1:]), np.float32)
        arrays["pose_directions"] = np.concatenate([pose[vertices], zero_directions])
    if body.expression_matrix is not None:
        arrays["expression_matrix"] = body.expression_matrix
    return arrays


def _bounded_weights(effects: Floats, targets: Floats, misfit: float) -> Floats:
    """Return the weights (K, T) in [0, 1] with which `effects` (P, K) best fit `targets`."""
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
