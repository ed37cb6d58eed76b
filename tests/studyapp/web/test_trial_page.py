from __future__ import annotations

import pytest
from flask import Flask

from motion.segment import EMOTIONS
from studyapp.study.settings.questions import QUALITY_CATEGORIES
from studyapp.web.language import language_of, speak
from studyapp.web.participants.trial_page import (
    CATEGORY_LABELS,
    EMOTION_WORDS,
    SCALE,
    emphasised,
    frozen_words,
)
from tests.studyapp.made_study import make_study


def test_the_scale_is_symmetric_and_in_the_order_of_the_videos() -> None:
    assert [value for value, _ in SCALE] == [-2, -1, 0, 1, 2]
    mirrored = [str(label).translate(str.maketrans("AB", "BA")) for _, label in reversed(SCALE)]
    assert mirrored == [str(label) for _, label in SCALE]


def test_the_emotion_is_emphasised_in_its_place() -> None:
    assert emphasised("{emotion}: which shows {emotion}?", "{emotion}", "fear") == (
        ("fear", True),
        (": which shows ", False),
        ("fear", True),
        ("?", False),
    )


@pytest.mark.parametrize(
    ("freeze", "words"),
    [
        ([], ""),
        (["face"], "the face"),
        (["face", "hands"], "the face and the fingers"),
        (["face", "hands", "lower_body"], "the face, the fingers and the legs"),
    ],
)
def test_what_is_kept_still_is_said_in_words(freeze: list[str], words: str) -> None:
    app = Flask("test")
    speak(app, language_of("en"))

    with app.app_context():
        assert frozen_words(make_study(freeze=freeze)) == words


def test_every_emotion_and_category_has_words() -> None:
    assert [str(word) for word in EMOTION_WORDS.values()] == list(EMOTIONS) == list(EMOTION_WORDS)
    assert tuple(str(word) for word in CATEGORY_LABELS) == QUALITY_CATEGORIES
