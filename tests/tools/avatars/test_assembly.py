from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer.look import AVATARS, BACKGROUND, default_body
from tools.avatars.assembly import build_body
from tools.avatars.recipes import RECIPES
from tools.avatars.sample_poses import SAMPLE_POSES
from tools.avatars.sheet import COLUMNS, avatar_sheet


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mannequin", "skeleton"])
def test_the_shipped_body_is_what_its_recipe_makes(name: str) -> None:
    made = build_body(next(recipe for recipe in RECIPES if recipe.name == name))
    with np.load(default_body(name), allow_pickle=False) as shipped:
        assert set(shipped.files) == set(made)
        for key in set(made) - {"credits", "material_names"}:
            np.testing.assert_allclose(made[key], shipped[key], atol=1e-5, err_msg=key)


def test_every_avatar_has_a_recipe() -> None:
    assert [recipe.name for recipe in RECIPES] == list(AVATARS)


def test_a_sheet_shows_the_body_in_every_pose(body_path: Path) -> None:
    size = 64
    sheet = np.asarray(avatar_sheet(body_path, "upper body", size=size)).astype(int)
    rows = -(-len(SAMPLE_POSES) // COLUMNS)
    assert sheet.shape == (rows * size, COLUMNS * size, 3)
    tiles = sheet.reshape(rows, size, COLUMNS, size, 3).swapaxes(1, 2).reshape(-1, size, size, 3)
    shown = np.abs(tiles - BACKGROUND).max(axis=3) > 20
    assert shown[: len(SAMPLE_POSES)].mean(axis=(1, 2)).min() > 0.1
    assert len(np.unique(tiles, axis=0)) >= len(SAMPLE_POSES) - 3  # three move only the face
