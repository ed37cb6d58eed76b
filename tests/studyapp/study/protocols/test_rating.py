from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.questions import RatingQuestion
from studyapp.study.study_file import new_study
from tests.studyapp.study.protocols.made_protocols import LABELS, make, question
from tests.support.studies.made_study import make_segments


def scale(name: str, **more: Any) -> RatingQuestion:
    return RatingQuestion.model_validate(question("q", scale=name, **more))


def test_the_template_has_two_sets_of_eight_groups_and_two_questions(tmp_path: Any) -> None:
    study = new_study(tmp_path / "study.toml", template="rating", name="s")

    assert isinstance(study, RatingStudy)
    assert [part.groups for part in study.sets] == [8, 8]
    assert (study.participants, len(study.questions)) == (90, 2)
    assert [len(part.conditions) for part in study.sets] == [4, 3]
    assert [field.name for field in study.form.eligibility] == ["adult", "senses"]
    plan = study.plan(study.arms[0], 0, make_segments(EMOTIONS * 2))
    assert Counter((trial.part, trial.kind) for trial in plan) == {
        ("all", "main"): 8,
        ("timing", "main"): 8,
        ("all", "attention"): 1,
        ("timing", "attention"): 1,
    }


@given(st.integers(0, 50), st.integers(1, 20))
def test_a_group_is_one_speech_with_every_motion_of_its_set(number: int, segments: int) -> None:
    study = make("rating")

    for trial in study.plan(study.arms[0], number, make_segments(["anger"] * segments)):
        part = {"four": 4, "three": 3}[trial.part]
        assert len(set(trial.conditions)) == len(trial.videos) == part
        assert {s.segment for s in trial.stimuli} == {trial.segment.name}
        assert all(s.speech == s.segment for s in trial.stimuli)


@given(st.integers(0, 50))
def test_no_speech_comes_twice_where_there_are_enough(number: int) -> None:
    study = make("rating")

    plan = study.plan(study.arms[0], number, make_segments(["anger"] * 7))

    assert len({trial.segment for trial in plan}) == len(plan) == 7


@pytest.mark.parametrize(
    ("named", "values", "steps"),
    [
        (scale("labels", labels=LABELS), range(1, 6), {1: 1, 5: 5}),
        (scale("mean_opinion"), range(1, 6), {1: 1, 3: 3}),
        (scale("slider"), range(101), {0: 1, 19: 1, 20: 2, 79: 4, 80: 5, 100: 5}),
    ],
)
def test_scales_run_from_the_worst_to_the_best(
    named: RatingQuestion, values: range, steps: dict[int, int]
) -> None:
    assert named.values == values
    assert {value: named.step(value) for value in steps} == steps
