from __future__ import annotations

import numpy as np
import pytest

from renderer.avatars import default_body
from tools.avatars.assembly import build_body
from tools.avatars.recipes import RECIPES


@pytest.mark.slow
def test_the_shipped_body_is_what_its_recipe_makes() -> None:
    made = build_body(next(recipe for recipe in RECIPES if recipe.name == "mannequin"))
    with np.load(default_body("mannequin"), allow_pickle=False) as shipped:
        assert set(shipped.files) == set(made)
        for name in set(made) - {"credits", "material_names"}:
            np.testing.assert_allclose(made[name], shipped[name], atol=1e-5, err_msg=name)
