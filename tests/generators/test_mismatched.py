"""Mismatched: another segment's motion, nobody's own, everybody's a different one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.interface import SpeechSegment, StudyClips
from generators.mismatched import Mismatched, partners
from motion.errors import InputError
from motion.segment import Segment

Speak = Callable[..., SpeechSegment]


def of_length(*seconds: float) -> list[Segment]:
    return [
        Segment(name=f"s{k}", wav="a.wav", start=0, end=end, speaker="a", emotion="neutral")
        for k, end in enumerate(seconds)
    ]


@given(st.lists(st.floats(0.5, 60), min_size=2, max_size=12), st.integers(0, 2**32))
def test_nobody_keeps_their_own_motion_and_no_two_get_the_same(
    lengths: list[float], seed: int
) -> None:
    chosen = partners(of_length(*lengths), seed)
    assert all(taker != giver for taker, giver in chosen.items())
    assert sorted(chosen.values()) == sorted(chosen)


@given(st.permutations(of_length(4, 5, 6, 7)), st.integers(0, 100))
def test_the_order_of_the_segments_does_not_matter(order: list[Segment], seed: int) -> None:
    assert partners(order, seed) == partners(of_length(4, 5, 6, 7), seed)


def test_partners_long_enough_are_preferred() -> None:
    for seed in range(20):
        chosen = partners(of_length(10, 10, 4, 4), seed)
        assert {chosen["s0"], chosen["s1"]} == {"s0", "s1"}


def test_seeds_choose_different_partners() -> None:
    assert len({tuple(partners(of_length(*[5] * 6), seed).items()) for seed in range(10)}) > 5


def test_the_motion_is_the_partners(study: StudyClips, speak: Speak) -> None:
    speech = speak(study.segments[0].name, 4.0)
    clip = Mismatched().generate(speech, seed=3, frame_rate=25, source=study)
    partner = clip.provenance["motion_of_segment"]
    assert partner != speech.segment.name
    np.testing.assert_array_equal(clip.poses, study.clip(partner).poses[: len(clip)])


def test_a_short_partner_goes_on_backwards_without_a_jump(study: StudyClips, speak: Speak) -> None:
    speech = speak(study.segments[2].name, 15.0)
    clip = Mismatched().generate(speech, seed=3, frame_rate=25, source=study)
    own = study.clip(clip.provenance["motion_of_segment"])
    assert clip.provenance["continued_by_reversal"] == "true"
    largest = np.abs(np.diff(own.poses, axis=0)).max()
    assert np.abs(np.diff(clip.poses, axis=0)).max() <= largest + 1e-6
    np.testing.assert_array_equal(clip.poses[len(own)], own.poses[-2])


def test_a_study_of_one_segment_is_refused(speak: Speak) -> None:
    with pytest.raises(InputError, match="another segment"):
        partners(of_length(5), 0)


def test_a_segment_that_is_not_of_the_study_is_refused(study: StudyClips, speak: Speak) -> None:
    with pytest.raises(InputError, match="stranger"):
        Mismatched().generate(speak("stranger", 4.0), seed=0, frame_rate=25, source=study)
