from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from renderer.look import AVATARS, BACKGROUND, default_body
from tools.avatars.assembly import build_body
from tools.avatars.colours import open_sky
from tools.avatars.patch import Patch, boundary_edges
from tools.avatars.recipes import RECIPES
from tools.avatars.sample_poses import SAMPLE_POSES
from tools.avatars.sheet import COLUMNS, avatar_sheet

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


@pytest.mark.slow
def test_the_shipped_body_is_what_its_recipe_makes() -> None:
    made = build_body(next(recipe for recipe in RECIPES if recipe.name == "mannequin"))
    with np.load(default_body("mannequin"), allow_pickle=False) as shipped:
        assert set(shipped.files) == set(made)
        for name in set(made) - {"credits", "material_names"}:
            np.testing.assert_allclose(made[name], shipped[name], atol=1e-5, err_msg=name)


def test_every_avatar_has_a_recipe() -> None:
    assert [recipe.name for recipe in RECIPES] == list(AVATARS)


def _plate(side: float, height: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a square of small triangles that faces upwards."""
    count = round(side / 0.008)  # triangles as small as the avatar's
    line = np.linspace(-side / 2, side / 2, count)
    points = np.array([(x, height, z) for z in line for x in line])
    corners = np.array([k * count + j for k in range(count - 1) for j in range(count - 1)])
    a, b, c, d = corners, corners + 1, corners + count + 1, corners + count
    return points, np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])


def test_an_open_plate_sees_the_whole_sky() -> None:
    points, faces = _plate(0.3, 0.0)
    assert open_sky(points, faces).min() > 0.95


def test_a_plate_under_a_close_larger_one_sees_almost_nothing() -> None:
    low, faces = _plate(0.2, 0.0)
    high, roof = _plate(0.6, 0.03)
    sky = open_sky(np.concatenate([low, high]), np.concatenate([faces, roof + len(low)]))
    assert sky[: len(low)].mean() < 0.15
    assert sky[len(low) :].min() > 0.95


def test_a_sheet_shows_the_body_in_every_pose(body_path: Path) -> None:
    size = 64
    sheet = np.asarray(avatar_sheet(body_path, "upper body", size=size)).astype(int)
    rows = -(-len(SAMPLE_POSES) // COLUMNS)
    assert sheet.shape == (rows * size, COLUMNS * size, 3)
    tiles = sheet.reshape(rows, size, COLUMNS, size, 3).swapaxes(1, 2).reshape(-1, size, size, 3)
    shown = np.abs(tiles - BACKGROUND).max(axis=3) > 20
    assert shown[: len(SAMPLE_POSES)].mean(axis=(1, 2)).min() > 0.1
    assert len(np.unique(tiles, axis=0)) >= len(SAMPLE_POSES) - 3  # three move only the face
