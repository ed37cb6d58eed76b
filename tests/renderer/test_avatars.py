from __future__ import annotations

import re

import pytest

from motion.errors import InputError
from renderer.avatars import AVATARS, COMMON_COLOURS, FIRST, avatar_named


def test_there_are_four_people_to_choose_from_and_a_mannequin_without_a_face() -> None:
    faces = [avatar for avatar in AVATARS.values() if avatar.has_face]
    assert len(faces) >= 4
    assert not AVATARS["mannequin"].has_face


def test_the_first_avatar_is_the_one_shown_where_none_is_chosen() -> None:
    assert next(iter(AVATARS)) == FIRST


def test_each_avatar_is_listed_by_its_name_and_described() -> None:
    for name, avatar in AVATARS.items():
        assert avatar.name == name
        assert avatar.description


def test_people_differ_in_build_skin_hair_and_clothes() -> None:
    people = [avatar for avatar in AVATARS.values() if avatar.has_face]
    for told in ("height", "hair", "top", "description"):
        assert len({getattr(person, told) for person in people}) == len(people)
    assert len({person.palette["skin"] for person in people}) == len(people)


def test_the_mannequin_has_one_colour() -> None:
    assert len(set(AVATARS["mannequin"].palette.values())) == 1


def test_every_colour_is_written_as_hex() -> None:
    for palette in (COMMON_COLOURS, *(avatar.palette for avatar in AVATARS.values())):
        for material, colour in palette.items():
            assert re.fullmatch("#[0-9a-f]{6}", colour), material


def test_an_unknown_avatar_is_refused() -> None:
    with pytest.raises(InputError, match=r"Use one of alex, maya, .*mannequin"):
        avatar_named("nobody")
