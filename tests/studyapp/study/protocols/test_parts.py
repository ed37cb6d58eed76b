"""Studies of several parts: ratings, rankings and mismatches."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.trial import AnswerKey
from studyapp.study.settings.questions import RatingQuestion
from tests.studyapp.study.protocols.made_protocols import LABELS, lasting, make, question
from tests.support.studies.made_study import make_segments


@given(st.integers(0, 50), st.integers(1, 20))
def test_a_group_is_one_speech_with_every_motion_of_its_set(number: int, segments: int) -> None:
    study = make("rating")

    plan = study.plan(study.arms[0], number, make_segments(["anger"] * segments))

    for trial in plan:
        part = {"four": 4, "three": 3}[trial.part]
        assert len(set(trial.conditions)) == len(trial.videos) == part
        assert {s.segment for s in trial.stimuli} == {trial.segment.name}
        assert all(s.speech == s.segment for s in trial.stimuli)
    assert segments < 7 or len({trial.segment for trial in plan}) == len(plan) == 7


@pytest.mark.parametrize(
    ("keys", "values", "steps"),
    [
        ({"scale": "labels", "labels": LABELS}, range(1, 6), {1: 1, 5: 5}),
        ({"scale": "mean_opinion"}, range(1, 6), {1: 1, 3: 3}),
        ({"scale": "slider"}, range(101), {0: 1, 19: 1, 20: 2, 79: 4, 80: 5, 100: 5}),
    ],
)
def test_scales_run_from_worst_to_best(
    keys: dict[str, object], values: range, steps: dict[int, int]
) -> None:
    asked = RatingQuestion.model_validate(question("q", **keys))

    assert asked.values == values
    assert {value: asked.step(value) for value in steps} == steps


def test_a_block_has_the_segments_of_its_length() -> None:
    blocks = [
        {"name": "long", "conditions": ["ours", "theirs", "static"], "trials": 8, "shortest": 30},
        {"name": "short", "conditions": ["ours", "theirs"], "trials": 12, "longest": 30},
    ]
    study = make("ranking", blocks=blocks)

    plan = study.plan(study.arms[0], 0, lasting(*[60.0] * 9, *[10.0] * 13))

    shown = [(trial.part, trial.segment.duration) for trial in plan]
    assert shown == [("long", 60.0)] * 8 + [("short", 10.0)] * 12
    assert len({trial.segment for trial in plan}) == 20


@pytest.mark.parametrize(
    ("ranks", "with_ties"),
    [((1, 1, 2), ""), ((1, 1, 1), ""), ((1, 1, 3), "left out"), ((2, 2, 3), "left out")],
)
def test_ties_are_accepted_only_where_the_study_says_so(
    ranks: tuple[int, ...], with_ties: str
) -> None:
    strict, tolerant = make("ranking"), make("ranking", ties=True)
    trial = strict.plan(strict.arms[0], 0, make_segments(["anger"] * 8))[0]
    answers: dict[AnswerKey, int] = {
        (question.name, number): rank
        for question in strict.questions
        for number, rank in enumerate(ranks, 1)
    }

    assert "question 1, two videos have the same rank" in str(strict.problem(trial, answers))
    problem = tolerant.problem(trial, answers)
    assert with_ties in str(problem)
    assert (problem is not None) == bool(with_ties)


ONE_OF_EACH = make_segments(EMOTIONS)


@given(st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_a_mismatch_study_asks_about_fit_and_about_realism(number: int, seed: int) -> None:
    study = make("mismatch", seed=seed)

    plan = study.plan(study.arms[0], number, ONE_OF_EACH)

    fit, real = ([t for t in plan if t.part == part] for part in study.parts)
    assert (len(fit), len(real)) == (7, 5)
    for trial in fit:
        assert len(set(trial.conditions)) == 1
        assert {shown.segment for shown in trial.stimuli} == {trial.segment.name}
        own, other = sorted(trial.stimuli, key=lambda s: s.speech != s.segment)
        assert own.speech == own.segment
        assert other.speech not in (None, other.segment)
    left = sum(trial.stimuli[0].speech == trial.segment.name for trial in fit)
    assert abs(2 * left - len(fit)) <= 1
    for trial in real:
        assert len(set(trial.conditions)) == 2
        assert {shown.speech for shown in trial.stimuli} == {None}


def test_each_motion_needs_two_videos() -> None:
    study = make("mismatch", realism=0, questions=[question("fit")])

    contents = list(study.contents(ONE_OF_EACH))

    per_motion = Counter((c[0].condition, c[0].segment) for c in contents)
    assert set(per_motion.values()) == {2}
    assert len(per_motion) == len(study.conditions) * len(ONE_OF_EACH)


@given(st.lists(st.sampled_from([2.0, 5.0, 9.0]), min_size=2, max_size=8))
def test_other_speech_matches_the_motions_length_if_possible(seconds: list[float]) -> None:
    study = make("mismatch", realism=0, questions=[question("fit")])
    segments = lasting(*seconds)
    length = {segment.name: segment.duration for segment in segments}
    short = []

    for (shown,) in study.contents(segments):
        others = [length[s.name] for s in segments if s.name != shown.segment]
        assert shown.speech is not None
        if length[shown.speech] < length[shown.segment]:
            assert max(others) == length[shown.speech]
            short.append(shown.segment)

    assert bool(study.notes(segments)) == bool(short)
