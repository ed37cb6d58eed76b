"""A piece of surface whose vertices are blends of a source mesh's vertices.

Cutting and refining only insert vertices between two others. So each vertex is a weighted mean of
source vertices, and the values of the source (positions, skin weights, facial actions) follow by
one matrix product.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch:
    """A triangle mesh over a source mesh.

    Attributes
    ----------
    blend : sparse matrix, shape (n, V)
        Each vertex as a weighted mean of the V source vertices; rows sum to one.
    faces : ndarray, shape (F, 3)
        Triangles over the n vertices, counter-clockwise seen from outside.
    lift : ndarray, shape (n,)
        Height of each vertex above the source surface along its normal, in metres.
    """

    blend: sparse.csr_array
    faces: Indices
    lift: Array

    @classmethod
    def of(cls, quads: Indices, source_size: int) -> Self:
        """Return the patch of the source's own `quads`, shape (F, 4)."""
        faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        used, flat = np.unique(faces, return_inverse=True)
        blend = sparse.csr_array(
            (np.ones(len(used)), (np.arange(len(used)), used)), shape=(len(used), source_size)
        )
        return cls(blend=blend, faces=flat.reshape(-1, 3), lift=np.zeros(len(used)))

    def __len__(self) -> int:
        """Return the number of vertices."""
        return len(self.lift)

    def take(self, values: Array) -> Array:
        """Return the source's per-vertex `values`, shape (V, …), blended onto this patch."""
        flat = self.blend @ values.reshape(len(values), -1)
        return np.asarray(flat.reshape(len(self), *values.shape[1:]))

    def raised(self, lift: Array | float) -> Self:
        """Return the patch raised by `lift` further off the source surface."""
        return replace(self, lift=self.lift + lift)

    def keeping(self, faces: NDArray[np.bool_]) -> Self:
        """Return the patch of the marked `faces`, without unused vertices."""
        used, flat = np.unique(self.faces[faces], return_inverse=True)
        return replace(
            self, blend=self.blend[used], faces=flat.reshape(-1, 3), lift=self.lift[used]
        )

    def inside(self, marked: NDArray[np.bool_]) -> Self:
        """Return the faces with all corners on `marked` vertices, as `keeping` does."""
        return self.keeping(np.asarray(marked[self.faces].all(axis=1)))

    def touching(self, marked: NDArray[np.bool_]) -> Self:
        """Return the faces with any corner on a `marked` vertex, as `keeping` does."""
        return self.keeping(np.asarray(marked[self.faces].any(axis=1)))

    def split(self, field: Array) -> tuple[Self, Array]:
        """Return the patch with new vertices where `field`, given per vertex, crosses zero.

        Returns
        -------
        patch : Patch
            The new patch; none of its triangles has corners on both sides.
        field : ndarray
            The field at its vertices; zero at the new ones.
        """
        field = np.where(np.abs(field) < 1e-9, 1e-9, field)
        above = field > 0
        crossed = above[self.faces].any(axis=1) & ~above[self.faces].all(axis=1)
        faces = self.faces[crossed]
        lone_above = above[faces].sum(axis=1) == 1
        lone = np.argmax(above[faces] == lone_above[:, None], axis=1)
        a, b, c = (faces[np.arange(len(faces)), (lone + k) % 3] for k in range(3))
        patch, (ab, ac), share = self._with_points_between([(a, b), (a, c)], field)
        new = np.concatenate(
            [
                np.stack([a, ab, ac], axis=1),
                np.stack([ab, b, c], axis=1),
                np.stack([ab, c, ac], axis=1),
            ]
        )
        patch = replace(patch, faces=np.concatenate([self.faces[~crossed], new]))
        return patch, share

    def cut(self, field: Array) -> Self:
        """Return the part where `field`, given per vertex, is positive, cut off cleanly."""
        patch, values = self.split(field)
        return patch.keeping(values[patch.faces].sum(axis=1) > 0)

    def refined(self, faces: NDArray[np.bool_]) -> Self:
        """Return the patch with each of the marked `faces` split into four."""
        a, b, c = self.faces[faces].T
        zero = np.zeros(len(self))
        patch, (ab, bc, ca), _ = self._with_points_between([(a, b), (b, c), (c, a)], zero)
        inner = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        new = np.concatenate([np.stack(corners, axis=1) for corners in inner])
        halved = {
            tuple(sorted(pair)): middle
            for pair, middle in zip(
                np.concatenate(
                    [np.stack([a, b], 1), np.stack([b, c], 1), np.stack([c, a], 1)]
                ).tolist(),
                np.concatenate([ab, bc, ca]).tolist(),
                strict=True,
            )
        }
        rest = [
            piece for face in self.faces[~faces].tolist() for piece in _closing_gaps(face, halved)
        ]
        kept = np.array(rest, dtype=np.int64).reshape(-1, 3)
        return replace(patch, faces=np.concatenate([kept, new]))

    def _with_points_between(
        self, edges: list[tuple[Indices, Indices]], field: Array
    ) -> tuple[Self, list[Indices], Array]:
        """Return the patch with one vertex added per edge, where the edge crosses zero."""
        pairs = np.sort(np.concatenate([np.stack(edge, axis=1) for edge in edges]), axis=1)
        unique, where = np.unique(pairs, axis=0, return_inverse=True)
        left, right = unique.T
        difference = field[left] - field[right]
        share = np.where(difference == 0, 0.5, field[left] / np.where(difference, difference, 1))
        between = sparse.diags_array(1 - share) @ self.blend[left]
        between = between + sparse.diags_array(share) @ self.blend[right]
        patch = replace(
            self,
            blend=sparse.csr_array(sparse.vstack([self.blend, between])),
            lift=np.concatenate(
                [self.lift, (1 - share) * self.lift[left] + share * self.lift[right]]
            ),
        )
        numbers = np.split(len(self) + where.reshape(-1), len(edges))
        return patch, numbers, np.concatenate([field, np.zeros(len(unique))])


def joined(first: Patch, second: Patch) -> Patch:
    """Return one patch made of two over the same source."""
    return Patch(
        blend=sparse.csr_array(sparse.vstack([first.blend, second.blend])),
        faces=np.concatenate([first.faces, second.faces + len(first)]),
        lift=np.concatenate([first.lift, second.lift]),
    )


def boundary_edges(faces: Indices) -> Indices:
    """Return the directed edges, shape (E, 2), that belong to only one triangle."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max()) + 1
    there = edges[:, 0] * size + edges[:, 1]
    back = edges[:, 1] * size + edges[:, 0]
    return edges[~np.isin(there, back)]


def hemmed(patch: Patch, edges: Indices, depth: float) -> Patch:
    """Return the patch with a rim turned inwards by `depth` metres along boundary `edges`.

    It makes cloth look thick.
    """
    loop, flat = np.unique(edges, return_inverse=True)
    start, end = flat.reshape(-1, 2).T
    outer_start, outer_end = edges.T
    inner_start, inner_end = start + len(patch), end + len(patch)
    rim = np.concatenate(
        [
            np.stack([outer_start, inner_end, outer_end], axis=1),
            np.stack([outer_start, inner_start, inner_end], axis=1),
        ]
    )
    return Patch(
        blend=sparse.csr_array(sparse.vstack([patch.blend, patch.blend[loop]])),
        faces=np.concatenate([patch.faces, rim]),
        lift=np.concatenate([patch.lift, patch.lift[loop] - depth]),
    )


def lining(patch: Patch, depth: float) -> Patch:
    """Return the patch's inside, `depth` metres below it, which shows where cloth ends."""
    return replace(patch, faces=patch.faces[:, ::-1], lift=patch.lift - depth)


def vertex_normals(vertices: Array, faces: Indices) -> Array:
    """Return unit normals, shape (V, 3); faces count by their area."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(total, faces[:, corner], normals)
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12))


def _closing_gaps(face: list[int], halved: dict[tuple[int, ...], int]) -> list[list[int]]:
    """Return `face` split so that it meets refined neighbours without a gap."""
    middles = [halved.get(tuple(sorted((face[k], face[(k + 1) % 3])))) for k in range(3)]
    ring = [corner for k in range(3) for corner in (face[k], middles[k]) if corner is not None]
    if len(ring) == 3:
        return [face]
    start = next(k for k in range(3) if middles[k] is not None)
    at = ring.index(middles[start])  # type: ignore[arg-type]
    ring = ring[at:] + ring[:at]
    return [[ring[0], ring[k], ring[k + 1]] for k in range(1, len(ring) - 1)]
