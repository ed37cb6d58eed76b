from __future__ import annotations

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy import sparse

from tools.avatars.patch import Patch, boundary_edges
from tools.avatars.simplify import simplified

SIDE = 17


def _sheet() -> tuple[Patch, NDArray[np.float64]]:
    """Return a square patch with a hill in the middle, and where its vertices are."""
    x, y = np.meshgrid(np.linspace(-1, 1, SIDE), np.linspace(-1, 1, SIDE))
    height = 0.4 * np.exp(-8 * (x**2 + y**2))
    start = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    quads = np.stack([start, start + 1, start + 1 + SIDE, start + SIDE], axis=1)
    return Patch.of(quads, SIDE * SIDE), np.stack([x, y, height], axis=2).reshape(-1, 3)


def _ball() -> tuple[Patch, NDArray[np.float64]]:
    """Return a closed patch, and where its vertices are."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    at = np.array(ball.vertices)
    identity = sparse.csr_array(sparse.eye_array(len(at)))
    faces = np.array(ball.faces, dtype=np.int64)
    return Patch(blend=identity, faces=faces, lift=np.zeros(len(at))), at


@pytest.mark.parametrize("triangles", [400, 200, 80])
def test_no_more_triangles_remain_than_asked_for(triangles: int) -> None:
    sheet, at = _sheet()
    smaller, _ = simplified(sheet, [at], triangles)
    assert triangles - 8 <= len(smaller.faces) <= triangles


def test_every_vertex_that_remains_is_one_of_the_source() -> None:
    sheet, at = _sheet()
    smaller, _ = simplified(sheet, [at], 150)
    assert set(map(tuple, smaller.take(at))) <= set(map(tuple, at))
    np.testing.assert_array_equal(smaller.blend.sum(axis=1), 1)


def test_the_border_stays_where_it_is() -> None:
    sheet, at = _sheet()
    smaller, _ = simplified(sheet, [at], 120)
    border = smaller.take(at)[boundary_edges(smaller.faces)][..., :2]
    np.testing.assert_allclose(np.abs(border).max(axis=2), 1)
    a, b, c = (smaller.take(at)[corner, :2] for corner in smaller.faces.T)
    area = np.linalg.det(np.stack([b - a, c - a], axis=2)) / 2
    assert area.min() > 0
    assert area.sum() == pytest.approx(4)


def test_what_is_closed_stays_closed() -> None:
    ball, at = _ball()
    smaller, _ = simplified(ball, [at], 300)
    assert len(smaller.faces) <= 300
    assert len(boundary_edges(smaller.faces)) == 0


def test_the_line_between_two_kinds_stays_straight() -> None:
    sheet, at = _sheet()
    kinds = (at[sheet.faces].mean(axis=1)[:, 0] > 0).astype(np.int64)
    smaller, left = simplified(sheet, [at], 120, labels=kinds)
    x = smaller.take(at)[smaller.faces][..., 0]
    assert (x[left == 1] >= 0).all()
    assert (x[left == 0] <= 0).all()


def _area(patch: Patch, at: NDArray[np.float64]) -> float:
    a, b, c = (patch.take(at)[corner] for corner in patch.faces.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_what_is_flat_at_rest_keeps_the_folds_that_it_has_in_another_shape() -> None:
    sheet, at = _sheet()
    flat = at * [1, 1, 0]
    folded = flat.copy()
    folded[:, 2] = np.abs(np.mod(flat[:, 0] + 0.5, 1) - 0.5)
    lost = [
        _area(sheet, folded) - _area(simplified(sheet, shapes, 100)[0], folded)
        for shapes in ([flat], [flat, folded])
    ]
    assert lost[1] < 0.5 * lost[0]


def test_where_errors_count_more_the_surface_stays_closer() -> None:
    sheet, at = _sheet()
    left = np.where(at[:, 0] < 0, 100.0, 1.0)
    smaller, _ = simplified(sheet, [at], 100, importance=left)
    x = smaller.take(at)[:, 0]
    assert (x < 0).sum() > (x > 0).sum()
