"""The emotions' values mean something to the parts that use them."""

from __future__ import annotations

import pytest

from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_forms import FORMS
from motion.clip import ARKIT_NAMES
from motion.segment import EMOTIONS


def test_every_emotion_has_a_style() -> None:
    assert set(STYLES) == set(EMOTIONS)


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_its_gesture_forms_exist_and_can_be_chosen_for_either_number_of_hands(emotion: str) -> None:
    forms = [FORMS[name] for name in STYLES[emotion].gestures.forms]
    assert any(form.one_hand for form in forms)
    assert any(form.both_hands for form in forms)


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_its_facial_actions_are_arkit_actions_of_one_or_both_sides(emotion: str) -> None:
    face = STYLES[emotion].face
    for name, weight in [*face.steady.items(), *face.on_accent.items()]:
        assert name in ARKIT_NAMES or {f"{name}Left", f"{name}Right"} <= set(ARKIT_NAMES)
        assert 0 < weight <= 1
