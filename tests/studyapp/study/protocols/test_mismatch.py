from __future__ import annotations

from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from tests.studyapp.study.protocols.made_protocols import lasting, make, question
from tests.support.studies.made_study import make_segments

SEGMENTS = make_segments(EMOTIONS)


@given(st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_a_mismatch_study_asks_about_fit_and_about_realism(number: int, seed: int) -> None:
    study = make("mismatch", seed=seed)

    plan = study.plan(study.arms[0], number, SEGMENTS)

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

    contents = list(study.contents(SEGMENTS))

    per_motion = Counter((c[0].condition, c[0].segment) for c in contents)
    assert set(per_motion.values()) == {2}
    assert len(per_motion) == len(study.conditions) * len(SEGMENTS)


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
