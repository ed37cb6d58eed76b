from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from motion.segment import CUT_TOLERANCE, EMOTIONS, Segment, excerpt_bounds


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


@given(
    speech_rate=st.sampled_from([16000, 22050, 48000]),
    frame_rate=st.sampled_from([15.0, 25.0, 29.97, 30.0]),
    start=st.floats(0, 50),
    length=st.floats(0.1, 10),
)
def test_speech_and_motion_of_an_excerpt_last_equally_long(
    speech_rate: int, frame_rate: float, start: float, length: float
) -> None:
    durations = []
    for rate in (speech_rate, frame_rate):
        first, count = excerpt_bounds(start, start + length, rate=rate, length=round(60 * rate))
        assert abs(first / rate - start) <= 0.5 / rate + 1e-9
        durations.append(count / rate)
    assert abs(durations[0] - durations[1]) <= 0.5 / frame_rate + 0.5 / speech_rate + 1e-9


def test_neighbouring_excerpts_share_no_item() -> None:
    bounds = [excerpt_bounds(k * 10, (k + 1) * 10, rate=15, length=957) for k in range(6)]
    assert bounds == [(150 * k, 150) for k in range(6)]


def test_excerpt_may_end_a_little_late() -> None:
    assert excerpt_bounds(0, 1 + CUT_TOLERANCE, rate=100, length=100) == (0, 110)


@pytest.mark.parametrize(
    ("start", "end"),
    [(-0.1, 0.5), (0.5, 0.5), (0.6, 0.5), (0.5, 1.2), (1, 1.05), (0.5, 0.501), (0, float("nan"))],
)
def test_excerpt_outside_or_empty_is_refused(start: float, end: float) -> None:
    with pytest.raises(InputError, match=r"excerpt from .* was asked of 1\.00 s"):
        excerpt_bounds(start, end, rate=100, length=100)
