"""Cloth: MakeHuman's tights around the body, smoothed, cut, raised and hemmed.

The tights follow the body without its details, so that none shows through.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import cKDTree

from tools.avatars.patch import Patch, boundary_edges, hemmed, joined, lining
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]
Measure = Callable[[Array], Array]

TIGHTS: Final = "helper-tights"
_SMOOTHING_ROUNDS: Final = 6
_LINED: Final = 0.03
"""Metres from an opening within which the inside of the cloth leads down to the skin."""

_CLOSED: Final = -0.022
"""Metres off the body at which that inside ends: below skin and trousers, so that no hole shows."""


def fabric(sitter: Sitter) -> Patch:
    """Return cloth around the whole person, ready to be cut."""
    tights = sitter.patch(TIGHTS)
    at = tights.take(sitter.person.vertices)
    neck = sitter.joint("neck")
    near = (at[:, 1] > neck[1] - 0.22) & (np.abs(at[:, 0]) < 0.16) & (at[:, 2] > neck[2] - 0.1)
    tights = tights.refined(near[tights.faces].all(axis=1))
    return smoothed(tights, _SMOOTHING_ROUNDS)


def cut_along(sitter: Sitter, cloth: Patch, measures: Sequence[Measure]) -> Patch:
    """Return the part of `cloth` where every measure of its vertices is positive."""
    for measure in measures:
        cloth = cloth.cut(measure(cloth.take(sitter.person.vertices)))
    return cloth


def from_edge(sitter: Sitter, cloth: Patch) -> Array:
    """Return the distance of the vertices of `cloth` from its nearest border, in metres."""
    at = cloth.take(sitter.person.vertices)
    border = at[boundary_edges(cloth.faces)]
    along = [border[:, 0] + share * (border[:, 1] - border[:, 0]) for share in (0, 0.33, 0.67)]
    distance, _ = cKDTree(np.concatenate(along)).query(at)
    return np.asarray(distance)


def thick(sitter: Sitter, cloth: Patch, depth: float) -> tuple[Patch, NDArray[np.bool_]]:
    """Return `cloth` with a rim `depth` metres deep, and its inside near the openings.

    Through the opening of a sleeve one sees the inside close around the arm.

    Returns
    -------
    cloth : Patch
        Its own faces come first.
    added : ndarray of bool, shape (F,)
        Marks the new faces.
    """
    inner = lining(cloth.touching(from_edge(sitter, cloth) < _LINED), depth)
    border = cloth.take(sitter.person.vertices)[np.unique(boundary_edges(cloth.faces))]
    distance, _ = cKDTree(border).query(inner.take(sitter.person.vertices))
    deep = np.clip((distance - 0.4 * _LINED) / _LINED, 0, 1)
    inner = replace(inner, lift=(1 - deep) * inner.lift + deep * _CLOSED)
    whole = joined(hemmed(cloth, boundary_edges(cloth.faces), depth), inner)
    added = np.ones(len(whole.faces), bool)
    added[: len(cloth.faces)] = False
    return whole, added


def smoothed(patch: Patch, rounds: int) -> Patch:
    """Return the patch with every vertex drawn towards its neighbours, borders kept."""
    edges = np.concatenate([patch.faces[:, [0, 1]], patch.faces[:, [1, 2]], patch.faces[:, [2, 0]]])
    size = len(patch)
    near = sparse.csr_array((np.ones(len(edges)), edges.T), shape=(size, size))
    near = ((near + near.T) > 0).astype(float)
    mean = sparse.diags_array(1 / near.sum(axis=1)) @ near
    half = 0.5 * (sparse.eye_array(size) + mean)
    kept = np.unique(boundary_edges(patch.faces))
    moving = np.ones(size)
    moving[kept] = 0
    step = sparse.diags_array(moving) @ half + sparse.diags_array(1 - moving)
    blend = patch.blend
    for _ in range(rounds):
        blend = step @ blend
    return replace(patch, blend=sparse.csr_array(blend))
