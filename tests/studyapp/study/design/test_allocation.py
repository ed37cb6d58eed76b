from __future__ import annotations

from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.allocation import allocate_segments, even_quotas
from tests.studyapp.made_study import make_segments

AVAILABLE = st.dictionaries(
    st.sampled_from(EMOTIONS), st.integers(min_value=1, max_value=9), min_size=1
)


@given(AVAILABLE, st.integers(0, 60), st.integers(0, 50))
def test_quotas_add_up_and_never_exceed_what_there_is(
    available: dict[str, int], total: int, number: int
) -> None:
    quotas = even_quotas(available, total, number)

    assert sum(quotas.values()) == min(total, sum(available.values()))
    assert all(quotas[emotion] <= available[emotion] for emotion in available)


@given(AVAILABLE, st.integers(0, 60), st.integers(0, 50))
def test_quotas_differ_by_at_most_one_unless_an_emotion_has_given_all_it_has(
    available: dict[str, int], total: int, number: int
) -> None:
    quotas = even_quotas(available, total, number)

    largest = max(quotas.values())
    assert all(
        quotas[emotion] >= largest - 1 or quotas[emotion] == available[emotion]
        for emotion in available
    )


def test_what_cannot_be_shared_evenly_goes_round() -> None:
    available = {"anger": 5, "fear": 5, "neutral": 5}

    extra = [
        emotion
        for number in range(6)
        for emotion, count in even_quotas(available, 7, number).items()
        if count == 3
    ]

    assert Counter(extra) == {"anger": 2, "fear": 2, "neutral": 2}


def test_amuse_gets_three_segments_of_each_of_eight_emotions() -> None:
    segments = make_segments(EMOTIONS * 5)

    chosen = allocate_segments(segments, 24, number=3, seed=[1])

    assert Counter(segment.emotion for segment in chosen) == dict.fromkeys(EMOTIONS, 3)


@given(
    st.lists(st.sampled_from(EMOTIONS), min_size=1, max_size=30),
    st.integers(1, 30),
    st.integers(0, 10),
)
def test_a_participant_never_gets_a_segment_twice(
    emotions: list[str], total: int, number: int
) -> None:
    segments = make_segments(emotions)

    chosen = allocate_segments(segments, total, number=number, seed=[7])

    assert len(set(chosen)) == len(chosen) == min(total, len(segments))


def test_all_segments_are_judged_equally_often() -> None:
    segments = make_segments(["anger"] * 7 + ["fear"] * 7)

    shown = Counter(
        segment.name
        for number in range(7)
        for segment in allocate_segments(segments, 6, number=number, seed=[2])
    )

    assert set(shown.values()) == {3}


@given(
    st.lists(st.sampled_from(EMOTIONS), min_size=1, max_size=30),
    st.integers(1, 30),
    st.integers(0, 60),
)
def test_who_came_before_is_counted_at_once_as_one_by_one(
    emotions: list[str], total: int, number: int
) -> None:
    segments = make_segments(emotions)

    at_once = allocate_segments(segments, total, number=number, seed=[3])

    one_by_one = [total] * number
    assert at_once == allocate_segments(segments, total, number=number, seed=[3], before=one_by_one)
