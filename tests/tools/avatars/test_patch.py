from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tools.avatars.patch import Patch, boundary_edges, hemmed, joined, lining, vertex_normals

SIDE = 5
POINTS = np.array([(x, y, 0.0) for y in range(SIDE) for x in range(SIDE)])
QUADS = np.array(
    [
        (a, a + 1, a + 1 + SIDE, a + SIDE)
        for y in range(SIDE - 1)
        for x in range(SIDE - 1)
        for a in [y * SIDE + x]
    ]
)
SHEET = Patch.of(QUADS, len(POINTS))

fields = st.lists(st.floats(-1, 1), min_size=len(POINTS), max_size=len(POINTS)).map(np.array)


def _area(patch: Patch) -> NDArray[np.float64]:
    a, b, c = (patch.take(POINTS)[corner] for corner in patch.faces.T)
    return np.cross(b - a, c - a)[:, 2] / 2


@settings(deadline=None)
@given(field=fields)
def test_splitting_keeps_the_surface_and_leaves_no_triangle_on_both_sides(
    field: NDArray[np.float64],
) -> None:
    patch, values = SHEET.split(field)
    assert _area(patch).min() > -1e-12
    np.testing.assert_allclose(_area(patch).sum(), (SIDE - 1) ** 2)
    np.testing.assert_allclose(patch.blend.sum(axis=1), 1)
    corners = values[patch.faces]
    assert not ((corners > 1e-12).any(axis=1) & (corners < -1e-12).any(axis=1)).any()


@settings(deadline=None)
@given(height=st.floats(0.1, SIDE - 1.1))
def test_a_straight_cut_takes_off_exactly_what_lies_below(height: float) -> None:
    kept = SHEET.cut(SHEET.take(POINTS)[:, 1] - height)
    np.testing.assert_allclose(_area(kept).sum(), (SIDE - 1) * (SIDE - 1 - height), atol=1e-6)
    assert kept.take(POINTS)[:, 1].min() >= height - 1e-8


@settings(deadline=None)
@given(marks=st.lists(st.booleans(), min_size=len(QUADS) * 2, max_size=len(QUADS) * 2))
def test_refining_a_part_leaves_no_gap(marks: list[bool]) -> None:
    patch = SHEET.refined(np.array(marks))
    np.testing.assert_allclose(_area(patch).sum(), (SIDE - 1) ** 2)
    ends = patch.take(POINTS)[boundary_edges(patch.faces)]
    on_rim = np.isclose(ends, 0) | np.isclose(ends, SIDE - 1)
    assert on_rim[:, :, :2].any(axis=2).all()
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    np.testing.assert_allclose(length, 4 * (SIDE - 1))


def test_a_hem_turns_in_by_its_depth_and_a_lining_faces_the_other_way() -> None:
    raised = SHEET.raised(0.01)
    rimmed = hemmed(raised, boundary_edges(raised.faces), 0.004)
    assert len(rimmed) == len(raised) + 4 * (SIDE - 1)
    np.testing.assert_allclose(np.unique(rimmed.lift.round(6)), [0.006, 0.01])
    inside = lining(raised, 0.004)
    np.testing.assert_allclose(_area(inside), -_area(raised))
    both = joined(raised, inside)
    assert len(both) == 2 * len(raised)
    assert both.faces.max() == len(both) - 1


def test_normals_of_a_flat_sheet_point_where_its_faces_do() -> None:
    normals = vertex_normals(SHEET.take(POINTS), SHEET.faces)
    np.testing.assert_allclose(normals, np.tile([0.0, 0.0, 1.0], (len(SHEET), 1)))
