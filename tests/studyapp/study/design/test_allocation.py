from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.allocation import even_quotas, planned_trials
from tests.support.studies.made_study import make_segments

AVAILABLE = st.dictionaries(
    st.sampled_from(EMOTIONS), st.integers(min_value=1, max_value=9), min_size=1
)


@given(AVAILABLE, st.integers(0, 60), st.integers(0, 50))
def test_quotas_add_up_and_differ_by_at_most_one_unless_an_emotion_has_given_all_it_has(
    available: dict[str, int], total: int, number: int
) -> None:
    quotas = even_quotas(available, total, number)

    largest = max(quotas.values())
    assert sum(quotas.values()) == min(total, sum(available.values()))
    for emotion, there in available.items():
        assert min(largest - 1, there) <= quotas[emotion] <= there


AMUSE = {"trials": 24, "practice": 3}


def test_fewer_segments_shrink_the_study_and_it_says_why() -> None:
    count = planned_trials(make_segments(["neutral"] * 6), **AMUSE)

    assert (count.practice, count.analysed) == (3, 6)
    assert count.sentences == (
        "each participant judges 6 pairs instead of 24, because the study has 6 segments and "
        "shows each of them once",
    )
    fewer = planned_trials(make_segments(["neutral"] * 2), **AMUSE)
    assert (fewer.practice, fewer.analysed) == (2, 2)
    assert "2 trials are practice instead of 3" in fewer.sentences[1]


def test_an_emotion_with_too_few_segments_is_named() -> None:
    segments = make_segments(["anger"] * 5 + ["fear"] * 1)

    count = planned_trials(segments, **{**AMUSE, "trials": 6})

    assert count.sentences == (
        "the emotions are not shown equally often: an even share is 3 segments each, but there "
        "are fewer of fear (1)",
    )
