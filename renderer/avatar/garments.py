"""The clothes: a sweater, trousers and shoes, cut from MakeHuman's tights around the body.

The tights follow the body without its relief, so that nothing of it shows through the cloth.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import cKDTree

from renderer.avatar.patch import Patch, boundary_edges, hemmed, joined, lining
from renderer.avatar.pieces import Piece, Sitter

Array = NDArray[np.float64]

TRIM: Final = 0.035
"""Metres: how wide the bands at collar, cuffs and hem are."""

_TIGHTS: Final = "helper-tights"
_CUFF: Final = 0.99
_SMOOTHING_ROUNDS: Final = 6


def garments(sitter: Sitter) -> list[Piece]:
    """Return sweater, trousers and shoes."""
    tights = _smoothed(sitter.patch(_TIGHTS))
    hem = sitter.joint("left_hip")[1] + 0.015
    ankle = sitter.joint("left_ankle")[1]
    return [
        *_sweater(sitter, tights, hem),
        _trousers(sitter, tights, hem + 0.05, ankle + 0.01),
        *_shoes(sitter, tights, ankle + 0.06),
    ]


def collar_height(sitter: Sitter, vertices: Array) -> Array:
    """Return how far below the neckline `vertices` lie; it runs lower in front than behind."""
    neck = sitter.joint("neck")
    return np.asarray(neck[1] - 0.012 - 0.42 * (vertices[:, 2] - neck[2]) - vertices[:, 1])


def _sweater(sitter: Sitter, tights: Patch, hem: float) -> list[Piece]:
    """Return the sweater's body and its bands."""
    cloth = tights
    for measure in (
        lambda at: collar_height(sitter, at),
        lambda at: at[:, 1] - hem,
        lambda at: _CUFF - sitter.along_forearm(at, "left"),
        lambda at: _CUFF - sitter.along_forearm(at, "right"),
    ):
        cloth = cloth.cut(measure(cloth.take(sitter.person.vertices)))
    cloth, from_edge = cloth.split(_from_edge(sitter, cloth) - TRIM)
    at = cloth.take(sitter.person.vertices)
    slack = 0.009 + 0.008 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    on_arm = np.abs(at[:, 0]) > 0.2
    cloth = cloth.raised(np.where(on_arm, 0.007, slack))
    in_band = from_edge[cloth.faces].sum(axis=1) < 0
    inside = lining(cloth, 0.004)
    rimmed = joined(hemmed(cloth, boundary_edges(cloth.faces), 0.004), inside)
    band = np.ones(len(rimmed.faces), bool)
    band[: len(cloth.faces)] = in_band
    return sitter.pieces(rimmed, {"sweater": ~band, "trim": band}, part=_TIGHTS)


def _from_edge(sitter: Sitter, cloth: Patch) -> Array:
    """Return how far from the nearest border of `cloth` its vertices lie, in metres."""
    at = cloth.take(sitter.person.vertices)
    border = at[boundary_edges(cloth.faces)]
    along = [border[:, 0] + share * (border[:, 1] - border[:, 0]) for share in (0, 0.33, 0.67)]
    distance, _ = cKDTree(np.concatenate(along)).query(at)
    return np.asarray(distance)


def _trousers(sitter: Sitter, tights: Patch, top: float, bottom: float) -> Piece:
    cloth = tights
    for measure in (
        lambda at: np.where(np.abs(at[:, 0]) < 0.3, top - at[:, 1], -1.0),
        lambda at: at[:, 1] - bottom,
    ):
        cloth = cloth.cut(measure(cloth.take(sitter.person.vertices)))
    at = cloth.take(sitter.person.vertices)
    flare = 0.005 + 0.012 * np.clip(1 - (at[:, 1] - bottom) / 0.35, 0, 1)
    cloth = cloth.raised(flare)
    edges = boundary_edges(cloth.faces)
    low = at[edges, 1].max(axis=1) < bottom + 0.01
    return sitter.piece("trousers", hemmed(cloth, edges[low], 0.006), part=_TIGHTS)


def _shoes(sitter: Sitter, tights: Patch, top: float) -> list[Piece]:
    at = tights.take(sitter.person.vertices)
    floor = at[:, 1].min()
    shoes = tights.cut(top - at[:, 1]).raised(0.006)
    shoes, above = shoes.split(shoes.take(sitter.person.vertices)[:, 1] - floor - 0.018)
    sole = above[shoes.faces].sum(axis=1) < 0
    shoes = shoes.raised(np.where(above <= 0, 0.003, 0.0))
    return sitter.pieces(shoes, {"shoes": ~sole, "soles": sole}, part=_TIGHTS)


def _smoothed(patch: Patch) -> Patch:
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
    for _ in range(_SMOOTHING_ROUNDS):
        blend = step @ blend
    return replace(patch, blend=sparse.csr_array(blend))
