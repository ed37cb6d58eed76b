"""What the avatar is put together from: named pieces of surface, in Anny's stance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.face import ARKIT_NAMES
from motion.skeleton import joint_index
from renderer.avatar.anny_source import AnnyPerson
from renderer.avatar.patch import Patch, vertex_normals

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MATERIALS: Final = (
    "skin", "lips", "mouth", "teeth", "tongue", "sclera", "iris", "limbus", "pupil", "brow",
    "lash", "hair", "sweater", "trim", "trousers", "shoes", "soles", "nails",
)  # fmt: skip
"""What a vertex is made of; an avatar gives each of them a colour."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """One piece of one material.

    Attributes
    ----------
    material : str
        One of `MATERIALS`.
    vertices : ndarray, shape (n, 3)
        In metres, in Anny's stance.
    faces : ndarray, shape (F, 3)
        Triangles.
    weights : ndarray, shape (n, 55)
        Skin weights.
    actions : ndarray, shape (52, n, 3)
        Offsets of each facial action in the order of `motion.face.ARKIT_NAMES`.
    """

    material: str
    vertices: Array
    faces: Indices
    weights: Array
    actions: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Sitter:
    """The person to be dressed, with its joints and skin weights in SMPL-X's terms."""

    person: AnnyPerson
    joints: Array
    weights: Array

    @cached_property
    def actions(self) -> Array:
        """Facial actions of all source vertices, shape (52, V, 3)."""
        return np.stack([self.person.actions[name] for name in ARKIT_NAMES])

    def joint(self, name: str) -> Array:
        """Return where joint `name` is, shape (3,)."""
        return np.asarray(self.joints[joint_index(name)])

    def patch(self, *parts: str) -> Patch:
        """Return the patch of the named mesh parts."""
        quads = np.concatenate([self.person.parts[part] for part in parts])
        return Patch.of(quads, len(self.person.vertices))

    def mask(self, part: str, texture: NDArray[np.floating]) -> Array:
        """Return the grey value of `texture`, in [0, 1], at each source vertex of `part`."""
        size = len(texture)
        uv = np.zeros((len(self.person.vertices), 2))
        uv[self.person.parts[part]] = self.person.uv[self.person.part_uv[part]]
        column = np.clip((uv[:, 0] * size).astype(int), 0, size - 1)
        row = np.clip(((1 - uv[:, 1]) * size).astype(int), 0, size - 1)
        return np.asarray(texture[row, column], dtype=float)

    def along_forearm(self, vertices: Array, side: str) -> Array:
        """Return how far along the forearm `vertices` lie: 0 at the elbow, 1 at the wrist."""
        elbow, wrist = self.joint(f"{side}_elbow"), self.joint(f"{side}_wrist")
        outward = 1 if side == "left" else -1
        share = (vertices - elbow) @ (wrist - elbow) / ((wrist - elbow) @ (wrist - elbow))
        return np.where(vertices[:, 0] * outward > abs(elbow[0]) * 0.8, share, -1.0)

    def outwards(self, part: str) -> Array:
        """Return unit normals of mesh part `part` at the source vertices, shape (V, 3)."""
        quads = self.person.parts[part]
        faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        return vertex_normals(self.person.vertices, faces)

    def piece(
        self, material: str, patch: Patch, *, part: str = "body", actions: bool = False
    ) -> Piece:
        """Return all of `patch` as one piece; see `pieces`."""
        whole = {material: np.ones(len(patch.faces), bool)}
        return self.pieces(patch, whole, part=part, actions=actions)[0]

    def pieces(
        self,
        patch: Patch,
        materials: Mapping[str, NDArray[np.bool_]],
        *,
        part: str = "body",
        actions: bool = False,
    ) -> list[Piece]:
        """Return `patch` as one piece per material, which meet without a gap.

        Parameters
        ----------
        patch : Patch
            The whole surface.
        materials : mapping of str to ndarray, shape (F,)
            Which faces are of which material.
        part : str
            The mesh part over which the patch is lifted. Its normals know nothing of where the
            patch was cut, so that hems stay straight.
        actions : bool
            Whether facial actions move it.
        """
        normals = patch.take(self.outwards(part))
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        raised = patch.take(self.person.vertices) + patch.lift[:, None] * normals
        weights = patch.take(self.weights)
        moves = np.zeros((len(ARKIT_NAMES), len(patch), 3))
        if actions:
            moves = np.stack([patch.take(action) for action in self.actions])
        result = []
        for material, faces in materials.items():
            used, flat = np.unique(patch.faces[faces], return_inverse=True)
            result.append(
                Piece(
                    material=material,
                    vertices=raised[used],
                    faces=flat.reshape(-1, 3),
                    weights=weights[used],
                    actions=moves[:, used],
                )
            )
        return result
