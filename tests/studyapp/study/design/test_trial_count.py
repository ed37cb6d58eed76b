from __future__ import annotations

from studyapp.study.design.trial_count import planned_trials
from tests.studyapp.made_study import make_segments

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
