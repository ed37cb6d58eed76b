import numpy as np
import pytest

from renderer.look import AVATARS, default_body
from tools.avatars.assembly import build_body
from tools.avatars.recipes import RECIPES


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mannequin", "skeleton"])
def test_the_shipped_body_matches_its_recipe(name: str) -> None:
    made = build_body(next(recipe for recipe in RECIPES if recipe.name == name))
    with np.load(default_body(name), allow_pickle=False) as shipped:
        assert set(shipped.files) == set(made)
        for key in set(made) - {"credits", "material_names"}:
            np.testing.assert_allclose(made[key], shipped[key], atol=1e-5, err_msg=key)


def test_every_avatar_has_a_recipe() -> None:
    assert [recipe.name for recipe in RECIPES] == list(AVATARS)
