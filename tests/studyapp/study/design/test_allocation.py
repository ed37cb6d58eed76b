from __future__ import annotations

from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.allocation import allocate_segments, even_quotas, planned_trials
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


AMUSE = {"trials": 24, "practice": 3}


def test_fewer_segments_shrink_the_study_and_it_says_why() -> None:
    count = planned_trials(make_segments(["neutral"] * 6), **AMUSE)

    assert (count.practice, count.analysed) == (3, 6)
    assert count.sentences == (
        "each participant judges 6 pairs instead of 24, because the study has 6 segments and "
        "shows each of them once",
    )


def test_practice_shrinks_with_the_segments() -> None:
    count = planned_trials(make_segments(["neutral"] * 2), **AMUSE)

    assert (count.practice, count.analysed) == (2, 2)
    assert "2 trials are practice instead of 3" in count.sentences[1]


def test_an_emotion_with_too_few_segments_is_named() -> None:
    segments = make_segments(["anger"] * 5 + ["fear"] * 1)

    count = planned_trials(segments, **{**AMUSE, "trials": 6})

    assert count.sentences == (
        "the emotions are not shown equally often: an even share is 3 segments each, but there "
        "are fewer of fear 1",
    )
