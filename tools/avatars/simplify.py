"""Mesh simplification with as little change as possible to the surface in many shapes.

Edges are collapsed in the order of the quadric error (Garland and Heckbert 1997, "Surface
simplification using quadric error metrics"), summed over several shapes of the same mesh: the face
with its mouth open, a bent finger. Vertices are only moved onto neighbours, so that all remaining
ones are vertices of the source, with their skin weights and facial actions.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tools.avatars.patch import Patch

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_BORDER_WEIGHT: Final = 4.0
"""Cost of leaving a border relative to leaving the surface."""

_LENGTH_WEIGHT: Final = 3e-3
"""Cost of long edges where the surface is flat, so that triangles stay regular."""

_SHARE_A_PASS: Final = 0.25
_LEAST_COSINE: Final = 0.25
"""A collapse may neither rotate a triangle beyond this cosine nor make it that thin."""


def simplified(
    patch: Patch,
    shapes: Sequence[Array],
    triangles: int,
    *,
    importance: Array | None = None,
    labels: Indices | None = None,
) -> tuple[Patch, Indices]:
    """Return `patch` with about `triangles` triangles.

    Parameters
    ----------
    patch : Patch
        The patch to simplify; its borders are kept.
    shapes : sequence of ndarray, shape (n, 3)
        Positions of the patch's vertices in metres, in each of its shapes; the first one determines
        whether a triangle is folded.
    triangles : int
        Number of remaining triangles.
    importance : ndarray, shape (n,), or None
        Weight of an error at each vertex; 1 by default.
    labels : ndarray, shape (F,), or None
        Kinds of faces; the line between two kinds is kept like a border.

    Returns
    -------
    patch : Patch
        The simplified patch.
    labels : ndarray
        The kinds of its faces.
    """
    faces = patch.faces.copy()
    kinds = np.zeros(len(faces), np.int64) if labels is None else labels.copy()
    places = np.stack(shapes)
    scale = np.ones(len(patch)) if importance is None else importance
    quadrics = _quadrics(places, faces, kinds) * scale[None, :, None, None]
    while len(faces) > triangles:
        wanted = (len(faces) - triangles + 1) // 2
        merged = _pass(places, faces, kinds, quadrics, scale, wanted)
        if not merged:
            break
        target = np.arange(len(patch))
        for gone, kept in merged:
            target[gone] = kept
            quadrics[:, kept] += quadrics[:, gone]
        faces = target[faces]
        whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        faces, kinds = faces[whole], kinds[whole]
    used, flat = np.unique(faces, return_inverse=True)
    smaller = Patch(blend=patch.blend[used], faces=flat.reshape(-1, 3), lift=patch.lift[used])
    return smaller, kinds


def _quadrics(places: Array, faces: Indices, kinds: Indices) -> Array:
    """Return the quadric of each vertex in each shape, shape (S, n, 4, 4)."""
    result = np.zeros((places.shape[0], places.shape[1], 4, 4))
    feature, owner = _feature_edges(faces, kinds)
    for shape, at in enumerate(places):
        corners = at[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(normals, axis=1)
        normals /= np.maximum(area, 1e-20)[:, None]
        surface = _planes(normals, corners[:, 0]) * area[:, None, None]
        for corner in range(3):
            np.add.at(result[shape], faces[:, corner], surface)
        along = at[feature[:, 1]] - at[feature[:, 0]]
        square = (along**2).sum(axis=1)
        upright = np.cross(along, normals[owner])
        upright /= np.maximum(np.linalg.norm(upright, axis=1, keepdims=True), 1e-20)
        walls = _planes(upright, at[feature[:, 0]]) * (_BORDER_WEIGHT * square)[:, None, None]
        for end in range(2):
            np.add.at(result[shape], feature[:, end], walls)
    return result


def _planes(normals: Array, points: Array) -> Array:
    """Return the squared distance to each plane as a quadric, shape (n, 4, 4)."""
    plane = np.concatenate([normals, -(normals * points).sum(axis=1, keepdims=True)], axis=1)
    return np.asarray(np.einsum("na,nb->nab", plane, plane))


def _feature_edges(faces: Indices, kinds: Indices) -> tuple[Indices, Indices]:
    """Return the edges on a border or between kinds, each once, and a face at each."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(faces)), 3)
    unique, first, where, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    lowest = np.full(len(unique), np.iinfo(np.int64).max)
    highest = np.full(len(unique), -1)
    np.minimum.at(lowest, where.reshape(-1), kinds[owner])
    np.maximum.at(highest, where.reshape(-1), kinds[owner])
    feature = (count != 2) | (lowest != highest)
    return unique[feature], owner[first[feature]]


def _pass(
    places: Array, faces: Indices, kinds: Indices, quadrics: Array, scale: Array, wanted: int
) -> list[tuple[int, int]]:
    """Return vertices to move onto neighbours, cheapest first; no two are adjacent."""
    size = places.shape[1]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)
    feature, _ = _feature_edges(faces, kinds)
    on_feature = np.bincount(feature.ravel(), minlength=size)
    coded = np.unique(np.sort(feature, axis=1) @ np.array([size, 1]))
    is_feature = np.isin(np.sort(edges, axis=1) @ np.array([size, 1]), coded)
    start, end = edges.T
    allowed = (on_feature[start] == 0) | ((on_feature[start] == 2) & is_feature)
    start, end = start[allowed], end[allowed]
    point = np.concatenate([places[:, end], np.ones((len(places), len(end), 1))], axis=2)
    cost = np.einsum("sea,seab,seb->e", point, quadrics[:, start], point, optimize=True)
    square = ((places[:, end] - places[:, start]) ** 2).sum(axis=(0, 2))
    cost = cost + _LENGTH_WEIGHT * scale[start] * square**2
    order = np.argsort(cost, kind="stable")
    order = order[: max(64, int(len(order) * _SHARE_A_PASS))]
    around = _faces_around(faces, size)
    blocked = np.zeros(size, bool)
    merged: list[tuple[int, int]] = []
    for gone, kept in zip(start[order].tolist(), end[order].tolist(), strict=True):
        if blocked[gone] or blocked[kept]:
            continue
        mine = faces[around[gone]]
        if not _may_merge(places[0], faces, mine, around, gone, kept):
            continue
        merged.append((gone, kept))
        blocked[mine.ravel()] = True
        blocked[faces[around[kept]].ravel()] = True
        if len(merged) >= wanted:
            break
    return merged


def _faces_around(faces: Indices, size: int) -> list[Indices]:
    """Return the faces at each vertex."""
    order = np.argsort(faces.ravel(), kind="stable")
    counts = np.bincount(faces.ravel(), minlength=size)
    return np.split(order // 3, np.cumsum(counts)[:-1])


def _may_merge(
    at: Array, faces: Indices, mine: Indices, around: list[Indices], gone: int, kept: int
) -> bool:
    """Return whether moving `gone` onto `kept` neither folds nor pinches the surface."""
    shared = (mine == kept).any(axis=1)
    neighbours = np.intersect1d(mine, faces[around[kept]])
    if len(neighbours) - 2 != shared.sum():
        return False
    rest = mine[~shared]
    if not len(rest):
        return False
    before = at[rest]
    after = at[np.where(rest == gone, kept, rest)]
    old = np.cross(before[:, 1] - before[:, 0], before[:, 2] - before[:, 0])
    new = np.cross(after[:, 1] - after[:, 0], after[:, 2] - after[:, 0])
    length = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    longest = ((after - np.roll(after, 1, axis=1)) ** 2).sum(axis=2).max(axis=1)
    even = np.linalg.norm(new, axis=1) > 0.12 * longest
    return bool(((old * new).sum(axis=1) > _LEAST_COSINE * length).all() and even.all())
