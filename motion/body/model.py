"""The body layer: from a motion clip to the vertices of any body in SMPL-X's file format.

Shape, expression and pose blend shapes, then linear blend skinning, as in SMPL-X (Pavlakos et al.
2019, "Expressive Body Capture", section 3.1, equations 1-3), in NumPy and over many frames at
once, because drawing videos needs no gradients.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial.transform import Rotation

from motion.arrays import Floats, Floats32, Ints
from motion.body.abilities import read_expression_matrix
from motion.body.archive import body_archive
from motion.body.skinning import TwistJoints, skinning_matrices
from motion.clip import EXPRESSION_COUNT, MotionClip, arkit_index
from motion.errors import InputError
from motion.skeleton import JOINT_COUNT, PARENTS, joint_index

_REQUIRED: Final = (
    "v_template", "f", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table",
)  # fmt: skip
_SURFACE: Final = ("material", "material_names", "shade", "colours")
_PER_VERTEX: Final = (
    "v_template", "shapedirs", "posedirs", "weights", "twist_weights", "material", "shade",
    "colours",
)  # fmt: skip
_TWIST: Final = ("twist_bones", "twist_shares", "twist_weights")
_FULL_SHAPE_COUNT: Final = 300
_SHORT_SHAPE_COUNT: Final = 10  # SMPL-X files of 2019 hold 10 shape and 10 expression components
_FRAMES_AT_ONCE: Final = 8
_STILL: Final = 1e-7

_JAW_FULLY_OPEN: Final = 0.28
"""Radians of the jaw joint that open the default body's mouth as far as ARKit's jawOpen of 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyModel:
    """A body that a motion clip can animate.

    Attributes
    ----------
    template : ndarray, shape (V, 3), float32
        Vertices in T-pose, metres, y up, facing +z.
    faces : ndarray, shape (F, 3), int64
        Triangles.
    shape_directions : ndarray, shape (V, 3, S), float32
        Offsets for one unit of each shape coefficient.
    expression_directions : ndarray, shape (V, 3, E), float32
        Offsets for one unit of each expression coefficient or ARKit weight.
    pose_directions : ndarray, shape (V, 3, 486), float32, or None
        Pose correctives before skinning; None if there are none.
    joint_regressor : sparse matrix, shape (55, V)
        Joints as weighted sums of vertices.
    weights : sparse matrix, shape (V, 55 + K)
        Skin weights of the skeleton's joints, then of the K twist joints.
    twist_joints : TwistJoints or None
        Extra joints that keep the skin from wringing; a licensed body has none.
    has_arkit_slots : bool
        Whether the expression directions are ARKit's facial actions, in the order of
        `motion.clip.ARKIT_NAMES`, rather than SMPL-X's expression components.
    expression_matrix : ndarray, shape (100, 52), or None
        Converts a clip's face if the clip has only the other kind of face than this body: SMPL-X's
        expression coefficients (rows) to ARKit weights (columns), or the reverse.
    credits : str
        Authors of the body; empty if the file does not name them.
    surface : mapping of str to ndarray
        Further per-vertex arrays that a default body carries for drawing.
    """

    template: Floats32
    faces: Ints
    shape_directions: Floats32
    expression_directions: Floats32
    pose_directions: Floats32 | None
    joint_regressor: sparse.csr_array
    weights: sparse.csr_array
    twist_joints: TwistJoints | None = None
    has_arkit_slots: bool = False
    expression_matrix: Floats32 | None = None
    credits: str = ""
    surface: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def face(self, clip: MotionClip) -> Floats32 | None:
        """Return the clip's face as this body's parameters, shape (n, 52) or (n, 100), or None.

        A face that the clip has in these parameters takes precedence over a converted one.
        """
        native, foreign = (clip.arkit, clip.expressions)[:: 1 if self.has_arkit_slots else -1]
        matrix = self.expression_matrix
        if native is not None or foreign is None or matrix is None:
            return native
        return np.clip(foreign @ matrix, 0, 1) if self.has_arkit_slots else foreign @ matrix.T

    def expression_weights(self, clip: MotionClip) -> Floats32:
        """Return the weight of each expression direction, shape (n, E), or (n, 0) if all are 0.

        The weight of jawOpen is reduced by the opening of the jaw joint.
        """
        values = self.face(clip)
        if values is None or not np.any(values):
            return np.zeros((len(clip), 0), np.float32)
        slots = self.expression_directions.shape[2]
        weights = np.zeros((len(values), slots), np.float32)
        weights[:, : values.shape[1]] = values[:, :slots]
        jaw_open = arkit_index("jawOpen")
        if self.has_arkit_slots and jaw_open < slots:
            opened = clip.poses[:, joint_index("jaw"), 0] / _JAW_FULLY_OPEN
            action = weights[:, jaw_open]
            action[:] = np.where(opened > 0, np.maximum(action - opened, 0), action)
        return weights

    def joints(self, betas: NDArray[np.floating]) -> Floats:
        """Return the joints of the unposed body with shape `betas`, shape (55, 3), in metres."""
        return np.asarray(self.joint_regressor @ self.shaped(betas).astype(np.float64))

    def vertices(self, clip: MotionClip, frames: slice = slice(None)) -> Floats32:
        """Return the positions of the body's vertices in the `frames` of `clip`.

        Parameters
        ----------
        clip : MotionClip
            The motion. Betas without a shape direction are ignored, and `face` converts the face;
            `motion.body.abilities` reports what is lost. If both the jaw joint and ARKit's jawOpen
            open the mouth, the wider opening counts.
        frames : slice
            Which frames; all by default.

        Returns
        -------
        ndarray, shape (n, V, 3), float32
            Metres.
        """
        excerpt = clip.frames(frames)
        result = np.empty((len(excerpt), *self.template.shape), np.float32)
        for start in range(0, len(excerpt), _FRAMES_AT_ONCE):
            batch = slice(start, min(start + _FRAMES_AT_ONCE, len(excerpt)))
            self._skin(excerpt.frames(batch), result[batch])
        return result

    def unposed(self, clip: MotionClip) -> Floats32:
        """Return the vertices before skinning, shape (n, V, 3), in metres.

        They are in T-pose, with the clip's shape and expression and the pose's corrections.
        """
        result = np.repeat(self.shaped(clip.betas)[None], len(clip), axis=0)
        coefficients = self.expression_weights(clip)
        if coefficients.size:
            moved_vertices, directions, _ = self._expression_parts
            result[:, moved_vertices] += np.tensordot(coefficients, directions, axes=(1, 2))
        if self.pose_directions is not None:
            local = Rotation.from_rotvec(clip.poses[:, 1:].reshape(-1, 3).astype(float))
            change = (local.as_matrix() - np.eye(3)).reshape(len(clip), -1).astype(np.float32)
            result += np.tensordot(change, self.pose_directions, axes=(1, 2))
        return result

    def skinning_matrices(self, clip: MotionClip) -> Floats32:
        """Return each joint's transform of the unposed skin, shape (n, 55 + K, 3, 4).

        The vertices of a frame are the unposed ones, each moved by the sum of these matrices
        weighted with its row of `weights`.
        """
        return skinning_matrices(clip.poses, clip.trans, self._joints(clip), self.twist_joints)

    def shaped(self, betas: NDArray[np.floating]) -> Floats32:
        """Return the template with shape `betas`, shape (V, 3), in metres."""
        count = min(len(betas), self.shape_directions.shape[2])
        if not count or not np.any(betas[:count]):
            return self.template
        offsets = self.shape_directions[:, :, :count] @ np.asarray(betas[:count], np.float32)
        return np.asarray(self.template + offsets)

    def _joints(self, clip: MotionClip) -> Floats32:
        """Return the joints of the unposed body in each frame, shape (n, 55, 3)."""
        shaped = self.joint_regressor @ self.shaped(clip.betas)
        joints = np.broadcast_to(shaped, (len(clip), JOINT_COUNT, 3))
        coefficients = self.expression_weights(clip)
        if not coefficients.size:
            return joints
        joint_directions = self._expression_parts[2]
        return np.asarray(joints + np.tensordot(coefficients, joint_directions, axes=(1, 2)))

    def _skin(self, clip: MotionClip, out: Floats32) -> None:
        """Write the vertices of all frames of `clip` to `out`, shape (n, V, 3)."""
        out[:] = self.unposed(clip)
        matrices = self.skinning_matrices(clip)
        flat = matrices.transpose(1, 0, 2, 3).reshape(matrices.shape[1], -1)
        blended = (self.weights @ flat).reshape(-1, len(clip), 3, 4)
        for frame in range(len(clip)):
            matrix = blended[:, frame]
            moved_by = np.einsum("vab,vb->va", matrix[:, :, :3], out[frame])
            np.add(moved_by, matrix[:, :, 3], out=out[frame])

    @cached_property
    def _expression_parts(self) -> tuple[NDArray[np.int_], Floats32, Floats32]:
        """The vertices that expressions move, their directions, and those of the joints."""
        directions = self.expression_directions
        moved_vertices = np.flatnonzero(np.abs(directions).max(axis=(1, 2)) > _STILL)
        flat = self.joint_regressor @ directions.reshape(len(directions), -1)
        joints = flat.reshape(JOINT_COUNT, 3, -1).astype(np.float32)
        return moved_vertices, np.ascontiguousarray(directions[moved_vertices]), joints


def read_body(path: Path, *, expression_matrix: Path | None = None) -> BodyModel:
    """Read a body model from a file in SMPL-X's ``.npz`` layout.

    Parameters
    ----------
    path : Path
        The default body, or a licensed ``SMPLX_*.npz``. Nothing in it is unpickled.
    expression_matrix : Path or None
        A file for `motion.body.abilities.read_expression_matrix`.

    Raises
    ------
    InputError
        If the file is missing or not an archive, or an array is missing or has a wrong shape.
    """
    status = path.stat() if path.is_file() else None
    body = _body_in(path, status and (status.st_ino, status.st_mtime_ns, status.st_size))
    if expression_matrix is None:
        return body
    return replace(body, expression_matrix=read_expression_matrix(expression_matrix))


@lru_cache(maxsize=2)
def _body_in(path: Path, _state: tuple[int, ...] | None) -> BodyModel:
    """Read a body in this state of its file, without a matrix; kept, since it takes long."""
    with body_archive(path) as archive:
        missing = [name for name in _REQUIRED if name not in archive]
        if missing:
            raise InputError(
                f"the body model lacks {', '.join(missing)}",
                where=path,
                remedy="Give an SMPL-X model in .npz format (not SMPL, SMPL+H or MANO)",
            )
        arrays = {name: archive[name] for name in (*_REQUIRED, *_extras(archive.files))}
    _check_shapes(arrays, path)
    arrays = _without_spare_vertices(arrays)
    shapes = arrays.pop("shapedirs").astype(np.float32, copy=False)
    is_full = shapes.shape[2] >= _FULL_SHAPE_COUNT + EXPRESSION_COUNT
    shape_count = _FULL_SHAPE_COUNT if is_full else _SHORT_SHAPE_COUNT
    poses = arrays.pop("posedirs").astype(np.float32, copy=False)
    surface: dict[str, NDArray[Any]] = {name: arrays[name] for name in _SURFACE if name in arrays}
    return BodyModel(
        template=arrays["v_template"].astype(np.float32),
        faces=arrays["f"].astype(np.int64),
        shape_directions=_without_zeros_at_end(shapes[:, :, :shape_count]),
        expression_directions=_without_zeros_at_end(shapes[:, :, shape_count:]),
        pose_directions=poses if np.any(poses) else None,
        joint_regressor=sparse.csr_array(arrays["J_regressor"].astype(np.float32)),
        weights=sparse.csr_array(arrays.get("twist_weights", arrays["weights"]).astype(np.float32)),
        twist_joints=_twist_joints(arrays),
        has_arkit_slots=bool(arrays.get("arkit_slots", False)),
        credits=str(arrays.get("credits", "")),
        surface=surface,
    )


def _extras(names: list[str]) -> list[str]:
    optional = [*_SURFACE, "arkit_slots", "credits", "spare_vertices"]
    if all(name in names for name in _TWIST):
        optional += _TWIST
    return [name for name in optional if name in names]


def _twist_joints(arrays: Mapping[str, NDArray[Any]]) -> TwistJoints | None:
    if "twist_bones" not in arrays:
        return None
    return TwistJoints(
        bones=arrays["twist_bones"].astype(np.int64),
        shares=arrays["twist_shares"].astype(np.float64),
    )


def _check_shapes(arrays: Mapping[str, NDArray[Any]], path: Path) -> None:
    """Raise `InputError` unless the arrays have SMPL-X's shapes."""
    count = arrays["v_template"].shape[0] if arrays["v_template"].ndim else 0
    expected: dict[str, tuple[int | None, ...]] = {
        "v_template": (count, 3),
        "f": (None, 3),
        "shapedirs": (count, 3, None),
        "posedirs": (count, 3, 9 * (JOINT_COUNT - 1)),
        "J_regressor": (JOINT_COUNT, count),
        "weights": (count, JOINT_COUNT),
        "kintree_table": (2, JOINT_COUNT),
    }
    for name, shape in expected.items():
        actual_shape = arrays[name].shape
        fits = len(actual_shape) == len(shape) and all(
            size in (None, actual) for size, actual in zip(shape, actual_shape, strict=True)
        )
        if not fits:
            expected_shape = ", ".join("any" if size is None else str(size) for size in shape)
            raise InputError(
                f"{name} of the body model has shape {actual_shape}, expected ({expected_shape})",
                where=path,
                remedy=f"Give an SMPL-X model with {JOINT_COUNT} joints in .npz format",
            )
    if arrays["kintree_table"][0, 1:].tolist() != list(PARENTS[1:]):
        raise InputError(
            "the body model's joint tree is not SMPL-X's",
            where=path,
            remedy="Give an SMPL-X model in .npz format",
        )


def _without_spare_vertices(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the arrays without the spare vertices at the end.

    They exist for smplx, which looks up landmarks at fixed indices that a smaller body lacks.
    """
    count = len(arrays["v_template"]) - int(arrays.get("spare_vertices", 0))
    shortened = {name: arrays[name][:count] for name in _PER_VERTEX if name in arrays}
    return {**arrays, **shortened, "J_regressor": arrays["J_regressor"][:, :count]}


def _without_zeros_at_end(directions: Floats32) -> Floats32:
    """Return the directions up to the last one that moves anything."""
    used = np.flatnonzero(np.abs(directions).max(axis=(0, 1), initial=0.0))
    return directions[:, :, : used[-1] + 1 if len(used) else 0]
