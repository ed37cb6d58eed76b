from collections import Counter

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.adaptive import most_informative_pairs
from studyapp.study.design.trial import Arm, PlannedTrial
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.support.studies.made_study import make_segments, make_study

Plan = tuple[PlannedTrial, ...]
Design = tuple[PairwiseStudy, Arm, Plan, Counter[str]]


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """Return a study, one arm, one participant's trials, and the emotions of all segments."""
    trials = draw(st.integers(1, 30))
    study = make_study(
        comparisons=draw(st.sampled_from(["with_reference", "all_pairs"])),
        trials=trials,
        practice=draw(st.integers(0, min(5, trials))),
        seed=draw(st.integers(0, 2**32 - 1)),
        catch={"trials": draw(st.integers(0, 6))},
    )
    emotions = draw(st.lists(st.sampled_from(EMOTIONS), min_size=1, max_size=30))
    arm = draw(st.sampled_from(study.arms))
    plan = study.plan(arm, draw(st.integers(0, 30)), make_segments(emotions))
    return study, arm, plan, Counter(emotions)


def of_kind(plan: Plan, *kinds: str) -> list[PlannedTrial]:
    return [trial for trial in plan if trial.kind in kinds]


@given(designs())
def test_segments_rotate_and_emotions_share_the_trials_evenly(design: Design) -> None:
    study, _, plan, available = design
    rounds = 1 if study.has_reference_arms else len(study.conditions) - 1

    times = Counter(trial.segment for trial in of_kind(plan, "main", "repeat"))

    assert times.total() == min(study.trials, rounds * available.total())
    rarest = min(times.values()) if len(times) == available.total() else 0
    assert max(times.values()) - rarest <= 1
    if study.has_reference_arms:
        of_emotion = Counter(segment.emotion for segment in times)
        largest = max(of_emotion.values())
        for emotion, count in available.items():
            assert min(largest - 1, count) <= of_emotion[emotion] <= count


@given(designs())
def test_practice_comes_first_and_is_repeated_in_order_at_the_end(design: Design) -> None:
    study, _, plan, available = design
    practice, repeats = of_kind(plan, "practice"), of_kind(plan, "repeat")

    assert list(plan[: len(practice)]) == practice
    if study.has_reference_arms:
        assert len(practice) == min(study.practice, study.trials, available.total())
    shown, again = (
        [(t.segment, {*t.conditions}) for t in trials] for trials in (practice, repeats)
    )
    assert again == shown
    assert [trial.repeats for trial in repeats] == [trial.position for trial in practice]
    last_main = max((trial.position for trial in of_kind(plan, "main")), default=0)
    assert all(trial.position > last_main for trial in repeats)


@given(designs())
def test_sides_are_balanced_within_each_kind_of_trial(design: Design) -> None:
    study, arm, plan, _ = design
    order = [*arm.conditions, study.catch.condition]

    for kinds in (("main", "repeat"), ("practice",), ("catch",)):
        trials = of_kind(plan, *kinds)
        in_order = sum(
            order.index(left) < order.index(right)
            for left, right in (trial.conditions for trial in trials)
        )
        assert abs(2 * in_order - len(trials)) <= 1


def test_adaptive_pairs_are_the_most_uncertain_ones() -> None:
    names, chance = ("a", "b", "c", "d"), np.random.default_rng(1)
    often = {("a", "b"): 20.0, ("b", "a"): 20.0}
    strengths = dict(zip(names, (3, 2, 1, 0), strict=True))
    unequal = {
        (a, b): 40.0 / (1 + np.exp(2 * (strengths[b] - strengths[a])))
        for a in names
        for b in names
        if a != b
    }

    assert len(set(most_informative_pairs(names, {}, 6, chance))) == 6
    assert ("a", "b") not in most_informative_pairs(names, often, 4, chance)
    # Neighbours are more informative than extremes.
    assert ("a", "d") not in most_informative_pairs(names, unequal, 6, chance)
