"""What generators share: frame counts, seeds, sources, and speech of any length."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.interface import SpeechSegment, required_source, seeded_stream, with_length
from generators.registry import load_generator
from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.segment import EMOTIONS
from tests.motion.random_clips import clip_of

Speak = Callable[..., SpeechSegment]


def counting(frames: int) -> MotionClip:
    """A clip whose frames can be told apart: trans holds the frame's number."""
    return clip_of(
        np.zeros((frames, 55, 3)), np.repeat(np.arange(float(frames))[:, None], 3, axis=1)
    )


@given(st.integers(1, 30), st.integers(1, 100))
def test_a_clip_is_fitted_to_any_length_without_a_jump(length: int, frames: int) -> None:
    numbers = with_length(counting(length), frames).trans[:, 0]
    assert len(numbers) == frames
    np.testing.assert_array_equal(numbers[:length], np.arange(min(length, frames)))
    assert (np.abs(np.diff(numbers)) <= 1).all()


def test_seeds_of_different_purposes_are_independent() -> None:
    draws = {
        purpose: np.random.default_rng(seeded_stream(3, *purpose)).random()
        for purpose in [("a",), ("b",), ("a", "b"), ("b", "a")]
    }
    assert len(set(draws.values())) == 4


def test_a_missing_source_is_named_with_its_generator() -> None:
    with pytest.raises(InputError, match="broken"):
        required_source(None, "broken")


@pytest.mark.parametrize(("samples", "rate"), [(600, 8000), (1500, 48000), (5000, 16000)])
def test_even_a_blink_of_speech_gets_its_motion(speak: Speak, samples: int, rate: int) -> None:
    noise = np.random.default_rng(0).normal(0, 0.1, samples).clip(-1, 1)
    speech = SpeechSegment(
        segment=speak("a", 1.0, EMOTIONS[2]).segment, audio=Audio(noise.astype(np.float32), rate)
    )
    frame_rate = 120.0
    clip = load_generator("rule_based").generate(speech, seed=0, frame_rate=frame_rate)
    assert len(clip) == round(samples / rate * frame_rate)
