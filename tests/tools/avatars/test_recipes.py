from __future__ import annotations

import re

from renderer.avatars import AVATARS
from tools.avatars.recipes import COMMON_COLOURS, RECIPES


def test_every_avatar_has_a_recipe() -> None:
    assert [recipe.name for recipe in RECIPES] == list(AVATARS)


def test_people_differ_in_build_skin_hair_and_clothes() -> None:
    people = [recipe for recipe in RECIPES if AVATARS[recipe.name].has_face]
    for told in ("height", "hair", "top"):
        assert len({getattr(person, told) for person in people}) == len(people)
    assert len({person.palette["skin"] for person in people}) == len(people)


def test_the_mannequin_has_one_colour() -> None:
    [palette] = [recipe.palette for recipe in RECIPES if recipe.name == "mannequin"]
    assert len(set(palette.values())) == 1


def test_every_colour_is_written_as_hex() -> None:
    for palette in (COMMON_COLOURS, *(recipe.palette for recipe in RECIPES)):
        for material, colour in palette.items():
            assert re.fullmatch("#[0-9a-f]{6}", colour), material
