from __future__ import annotations

import pytest

from motion.freeze import CHANNELS
from studyapp.design.preference import PREFERENCES
from studyapp.web.wording import (
    CHANNEL_WORDS,
    PREFERENCE_LABELS,
    SCALE,
    emphasised,
    frozen_words,
    letter,
)
from tests.studyapp.made_study import make_study


def test_the_scale_is_symmetric_and_in_the_order_of_the_videos() -> None:
    assert [value for value, _ in SCALE] == [-2, -1, 0, 1, 2]
    mirrored = [label.translate(str.maketrans("AB", "BA")) for _, label in reversed(SCALE)]
    assert mirrored == [label for _, label in SCALE]


@pytest.mark.parametrize("levels", sorted(PREFERENCES))
def test_every_preference_has_words(levels: int) -> None:
    assert [value for value, _ in PREFERENCE_LABELS[levels]] == list(PREFERENCES[levels])


def test_stimuli_are_lettered_in_order() -> None:
    assert [letter(number) for number in (1, 2, 3, 8)] == ["A", "B", "C", "H"]


def test_the_emotion_is_emphasised_in_its_place() -> None:
    assert emphasised("{emotion}: which shows {emotion}?", "fear") == (
        ("fear", True),
        (": which shows ", False),
        ("fear", True),
        ("?", False),
    )


@pytest.mark.parametrize(
    ("freeze", "words"),
    [
        ([], ""),
        (["face"], "face"),
        (["face", "hands"], "face and fingers"),
        (["face", "hands", "lower_body"], "face, fingers and legs"),
    ],
)
def test_what_is_kept_still_is_said_in_words(freeze: list[str], words: str) -> None:
    assert frozen_words(make_study(freeze=freeze)) == words


def test_every_channel_has_words() -> None:
    assert set(CHANNEL_WORDS) == set(CHANNELS)
