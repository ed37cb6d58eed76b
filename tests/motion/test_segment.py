from __future__ import annotations

from typing import Any

import pytest

from motion.errors import InputError
from motion.segment import EMOTIONS, Segment


def segment(**changes: Any) -> Segment:
    fields: dict[str, Any] = {
        "name": "a_01",
        "wav": "a.wav",
        "start": 0.0,
        "end": 10.0,
        "speaker": "scott",
        "emotion": "neutral",
    }
    return Segment(**{**fields, **changes})


def test_there_are_eight_emotions() -> None:
    assert len(set(EMOTIONS)) == 8


def test_duration_is_the_length_of_the_excerpt() -> None:
    assert segment(start=2.5, end=10.0).duration == 7.5


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"name": "../a"}, "segment name"),
        ({"name": ""}, "segment name"),
        ({"wav": "folder/a.wav"}, "plain file name"),
        ({"start": 3.0, "end": 3.0}, "no excerpt"),
        ({"start": -1.0}, "no excerpt"),
        ({"end": float("nan")}, "no excerpt"),
        ({"end": float("inf")}, "no excerpt"),
        ({"emotion": "boredom"}, "unknown emotion 'boredom'"),
    ],
)
def test_a_segment_refuses_what_it_cannot_be(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        segment(**changes)
