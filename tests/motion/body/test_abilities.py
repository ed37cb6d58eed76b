from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion.body.abilities import BodyAbilities, not_shown
from motion.clip import MotionClip
from motion.skeleton import joint_index

ARKIT, COEFFICIENTS = np.full((2, 52), 0.5), np.ones((2, 100))


def _body(**abilities: Any) -> BodyAbilities:
    usual = {"has_face": True, "has_arkit_slots": True, "has_matrix": False, "shapes": 0}
    return BodyAbilities(**(usual | abilities))


def _clip(**more: Any) -> MotionClip:
    poses = np.zeros((2, 55, 3))
    poses[:, joint_index("jaw"), 0] = more.pop("jaw", 0)
    return MotionClip(poses=poses, trans=np.zeros((2, 3)), frame_rate=30, **more)


@pytest.mark.parametrize(
    ("has_arkit_slots", "face", "given"),
    [
        (True, {"expressions": COEFFICIENTS}, "SMPL-X expression coefficients"),
        (False, {"arkit": ARKIT}, "ARKit weights"),
    ],
)
def test_face_in_other_terms_is_said_unless_a_matrix_turns_it(
    has_arkit_slots: bool, face: dict[str, np.ndarray], given: str
) -> None:
    body = _body(has_arkit_slots=has_arkit_slots)
    (sentence,) = not_shown(_clip(**face), body)
    assert f"given as {given}" in sentence
    assert "video.expression_matrix" in sentence
    turned = _body(has_arkit_slots=has_arkit_slots, has_matrix=True)
    assert not_shown(_clip(**face), turned) == ()


@pytest.mark.parametrize("face", [{"arkit": ARKIT}, {"expressions": COEFFICIENTS}, {"jaw": 0.2}])
def test_a_body_without_a_face_says_so(face: dict[str, Any]) -> None:
    (sentence,) = not_shown(_clip(**face), _body(has_face=False))
    assert "this body has none" in sentence


@pytest.mark.parametrize(
    "face",
    [{}, {"arkit": np.zeros((2, 52))}, {"arkit": np.zeros((2, 52)), "expressions": COEFFICIENTS}],
)
def test_nothing_is_said_of_a_face_that_is_shown_or_still(face: dict[str, np.ndarray]) -> None:
    assert not_shown(_clip(**face), _body()) == ()


@pytest.mark.parametrize(
    ("shapes", "betas", "sentence"),
    [
        (0, np.ones(10), "does not take on"),
        (10, np.ones(300), "only the first 10 of the clip's 300 betas"),
        (10, np.ones(10), None),
        (10, np.pad(np.ones(10), (0, 290)), None),
        (0, np.zeros(10), None),
    ],
)
def test_shape_that_the_body_does_not_take_on_is_said(
    shapes: int, betas: np.ndarray, sentence: str | None
) -> None:
    said = not_shown(_clip(betas=betas), _body(shapes=shapes))
    assert len(said) == (sentence is not None)
    assert sentence is None or sentence in said[0]
