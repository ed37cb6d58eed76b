from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

import numpy as np
import pytest

from motion.body.model import BodyModel, read_body
from motion.skeleton import JOINT_COUNT, REST_JOINTS, joint_index
from renderer.look import AVATARS, default_body
from tests.motion.random_clips import clip_of
from tools.avatars.anny_source import AnnyPerson, read_person
from tools.avatars.assembly import build_body
from tools.avatars.recipes import RECIPES


@pytest.fixture(scope="module")
def _read_once() -> Iterator[None]:
    """Recipes may begin with the same person, which takes seconds to read."""
    persons: dict[str, AnnyPerson] = {}

    def read(phenotype: Mapping[str, float], details: Mapping[str, float]) -> AnnyPerson:
        described = repr((phenotype, details))
        if described not in persons:
            persons[described] = read_person(phenotype, details)
        return persons[described]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tools.avatars.assembly.read_person", read)
        yield


@pytest.mark.slow
@pytest.mark.usefixtures("_read_once")
@pytest.mark.parametrize("name", ["mannequin", "skeleton"])
def test_the_shipped_body_matches_its_recipe(name: str) -> None:
    made = build_body(next(recipe for recipe in RECIPES if recipe.name == name))
    with np.load(default_body(name), allow_pickle=False) as shipped:
        assert set(shipped.files) == set(made)
        for key in set(made) - {"credits", "material_names"}:
            np.testing.assert_allclose(made[key], shipped[key], atol=1e-5, err_msg=key)


def test_every_avatar_has_a_recipe() -> None:
    assert [recipe.name for recipe in RECIPES] == list(AVATARS)


def _forearm_thickness(body: BodyModel, joint: str, turned: float) -> np.ndarray:
    """Return the mean squared distance of the left forearm's skin from its bone, slice by slice."""
    elbow, wrist = REST_JOINTS[[joint_index("left_elbow"), joint_index("left_wrist")]]
    poses = np.zeros((1, JOINT_COUNT, 3), np.float32)
    poses[0, joint_index(joint), 0] = np.radians(turned)
    clip = clip_of(poses)
    place = (body.template[:, 0] - elbow[0]) / (wrist[0] - elbow[0])
    near = np.linalg.norm((body.template - elbow)[:, 1:], axis=1) < 0.12
    offsets = (body.vertices(clip)[0] - elbow)[:, 1:]
    squared = (offsets**2).sum(axis=1)
    edges = np.linspace(0.1, 0.95, 9)
    return np.array(
        [
            squared[near & (place >= low) & (place < high)].mean()
            for low, high in itertools.pairwise(edges)
        ]
    )


@pytest.mark.parametrize("joint", ["left_wrist", "left_elbow"])
def test_the_default_bodys_twisted_forearm_keeps_its_thickness(joint: str) -> None:
    body = read_body(default_body())
    straight = _forearm_thickness(body, joint, 0)
    for turned in (-120, 120):
        assert (_forearm_thickness(body, joint, turned) / straight).min() > 0.85
