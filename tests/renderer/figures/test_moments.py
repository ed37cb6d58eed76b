from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.audio import Audio
from motion.errors import InputError
from renderer.figures.moments import Moment, even_moments, loud_moments

RATE = 8000


def speech(*syllables: float, seconds: float = 4.0) -> Audio:
    """Return silence with a short hum at each of `syllables`."""
    times = np.arange(round(seconds * RATE)) / RATE
    loud = np.zeros_like(times)
    for at in syllables:
        loud = np.maximum(loud, np.exp(-0.5 * ((times - at) / 0.05) ** 2))
    return Audio((0.5 * loud * np.sin(2 * np.pi * 200 * times)).astype(np.float32), RATE)


def test_a_moment_may_have_a_key_word() -> None:
    assert Moment.parse("2.4") == Moment(seconds=2.4)
    assert Moment.parse("never=2.4") == Moment(seconds=2.4, word="never")
    assert Moment.parse("a = b=1") == Moment(seconds=1, word="a = b")
    assert (Moment.parse("2.44").label, Moment.parse("no=1").label) == ("2.4 s", "no")


@pytest.mark.parametrize("text", ["", "soon", "word=", "2,4"])
def test_what_is_no_moment_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"'word=2\.4'"):
        Moment.parse(text)


@given(st.floats(0.1, 600), st.integers(1, 16))
def test_even_moments_are_in_order_and_within(duration: float, count: int) -> None:
    seconds = [moment.seconds for moment in even_moments(duration, count)]
    assert len(seconds) == count
    assert seconds == sorted(seconds)
    assert seconds[0] >= 0 and seconds[-1] <= duration


def test_loud_moments_are_the_stressed_syllables() -> None:
    found = loud_moments(speech(0.5, 1.6, 2.2, 3.5), 4)
    assert [moment.seconds for moment in found] == pytest.approx([0.5, 1.6, 2.2, 3.5], abs=0.03)


@given(st.lists(st.floats(0, 4), max_size=12), st.integers(1, 16))
def test_no_syllable_is_shown_twice(syllables: list[float], count: int) -> None:
    found = [moment.seconds for moment in loud_moments(speech(*syllables), count)]
    assert len(found) == count
    assert np.diff(found).min(initial=np.inf) >= 4.0 / count / 2 - 0.02


def test_silence_gives_moments_too() -> None:
    silence = Audio(np.zeros(2 * RATE, np.float32), RATE)
    assert [m.seconds for m in loud_moments(silence, 2)] == pytest.approx([0.5, 1.5], abs=0.02)
    short = Audio(np.zeros(80, np.float32), RATE)
    assert len(loud_moments(short, 5)) == 5
