from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.support.studies.made_study import make_segments, make_study, pair_plan


@st.composite
def designs(draw: st.DrawFn) -> tuple[PairwiseStudy, tuple[PlannedTrial, ...], int]:
    """Return a study, the trials of one participant, and how many segments there are."""
    trials = draw(st.integers(1, 30))
    study = make_study(
        trials=trials,
        practice=draw(st.integers(0, min(5, trials))),
        seed=draw(st.integers(0, 2**32 - 1)),
        catch={"trials": draw(st.integers(0, 6))},
    )
    emotions = draw(st.lists(st.sampled_from(EMOTIONS), min_size=1, max_size=30))
    plan = pair_plan(
        study, make_segments(emotions), other="static", number=draw(st.integers(0, 30))
    )
    return study, plan, len(emotions)


def of_kind(plan: tuple[PlannedTrial, ...], *kinds: str) -> list[PlannedTrial]:
    return [trial for trial in plan if trial.kind in kinds]


@given(designs())
def test_every_analysed_segment_comes_once(
    design: tuple[PairwiseStudy, tuple[PlannedTrial, ...], int],
) -> None:
    study, plan, segments = design

    names = [trial.segment.name for trial in of_kind(plan, "main", "repeat")]

    assert len(names) == len(set(names)) == min(study.trials, segments)


@given(designs())
def test_practice_comes_first_and_is_repeated_at_the_end_in_its_order(
    design: tuple[PairwiseStudy, tuple[PlannedTrial, ...], int],
) -> None:
    study, plan, segments = design
    practice, repeats = of_kind(plan, "practice"), of_kind(plan, "repeat")

    assert list(plan[: len(practice)]) == practice
    assert len(practice) == min(study.practice, study.trials, segments)
    assert [trial.segment for trial in repeats] == [trial.segment for trial in practice]
    assert [trial.repeats for trial in repeats] == [trial.position for trial in practice]
    last_main = max((trial.position for trial in of_kind(plan, "main")), default=0)
    assert all(trial.position > last_main for trial in repeats)


@given(designs())
def test_sides_are_balanced_among_the_analysed_the_practice_and_the_catch_trials(
    design: tuple[PairwiseStudy, tuple[PlannedTrial, ...], int],
) -> None:
    study, plan, _ = design

    for kinds in (("main", "repeat"), ("practice",), ("catch",)):
        trials = of_kind(plan, *kinds)
        left = sum(trial.conditions[0] == study.reference for trial in trials)
        assert abs(2 * left - len(trials)) <= 1


def tournament(count: int, trials: int) -> PairwiseStudy:
    """Return a study of all pairs of `count` conditions."""
    names: dict[str, dict[str, str]] = {f"c{index}": {} for index in range(count)}
    return make_study(comparisons="all_pairs", reference="c0", conditions=names, trials=trials)


def test_few_segments_come_again_with_other_pairs_but_not_before_all_have_come() -> None:
    study = tournament(5, trials=40)

    plan = study.plan(study.arms[0], 0, make_segments(EMOTIONS))

    heard = Counter(trial.segment.name for trial in of_kind(plan, "main", "repeat"))
    assert set(heard.values()) == {4}
    assert len(heard) == 8
    assert "shows each of them 4 times" in " ".join(study.notes(make_segments(EMOTIONS)))


@pytest.mark.parametrize("reference", ["rule_based", "static"])
def test_a_repeat_shows_the_pair_of_its_practice_trial(reference: str) -> None:
    study = make_study(comparisons="all_pairs", reference=reference)

    plan = study.plan(study.arms[0], 3, make_segments(EMOTIONS))

    for repeat in of_kind(plan, "repeat"):
        shown = plan[(repeat.repeats or 0) - 1]
        assert shown.kind == "practice"
        assert shown.segment == repeat.segment
        assert set(shown.conditions) == set(repeat.conditions)
