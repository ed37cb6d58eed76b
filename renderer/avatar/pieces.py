"""What the avatar is put together from: named pieces of surface, in Anny's stance."""

from __future__ import annotations

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

    def piece(self, material: str, patch: Patch, actions: bool = False) -> Piece:
        """Return `patch` as a piece; facial actions move it only where `actions` is true."""
        base = patch.take(self.person.vertices)
        normals = vertex_normals(base, patch.faces)
        return Piece(
            material=material,
            vertices=base + patch.lift[:, None] * normals,
            faces=patch.faces,
            weights=patch.take(self.weights),
            actions=np.stack([patch.take(action) for action in self.actions])
            if actions
            else np.zeros((len(self.actions), len(patch), 3)),
        )
