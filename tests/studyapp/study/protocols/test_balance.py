"""What each protocol's plan balances over many places, and what it leaves to chance."""

import hashlib
from collections import Counter
from collections.abc import Hashable, Iterable
from itertools import combinations
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.segment import EMOTIONS
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.settings.study import Study
from tests.studyapp.study.protocols.made_protocols import KEYS, make
from tests.support.studies.made_study import make_segments

SEGMENTS = make_segments(EMOTIONS * 4)
PLACES = st.integers(1, 40)
SEEDS = st.integers(0, 2**32 - 1)


def plans(study: Study, places: int) -> list[tuple[PlannedTrial, ...]]:
    (arm, *_) = study.arms
    return [study.plan(arm, number, SEGMENTS) for number in range(places)]


def analysed(study: Study, places: int) -> list[PlannedTrial]:
    return [
        trial for plan in plans(study, places) for trial in plan if trial.kind in ("main", "repeat")
    ]


def spread(counted: Iterable[Hashable], among: Iterable[Hashable]) -> int:
    """Return by how much the most and the least frequent of `among` differ."""
    counts = Counter(counted)
    of_each = [counts[one] for one in among]
    return max(of_each) - min(of_each)


def spread_of_speech(trials: Iterable[PlannedTrial]) -> int:
    """Return the difference between the most and the least used segment of an emotion."""
    heard = [trial.segment for trial in trials]
    return max(
        spread(heard, [segment for segment in SEGMENTS if segment.emotion == emotion])
        for emotion in EMOTIONS
    )


def extras(protocol: str, **changes: Any) -> Study:
    catch = {**KEYS[protocol].get("catch", {}), "trials": 2}
    return make(protocol, catch=catch, attention={"trials": 2}, **changes)


@settings(max_examples=15)
@given(PLACES, SEEDS, st.integers(1, 26))
def test_segments_of_an_emotion_are_judged_equally_often(
    places: int, seed: int, trials: int
) -> None:
    pairs = analysed(make("pairwise", seed=seed, trials=trials, practice=1), places)
    ranked = analysed(make("ranking", seed=seed), places)

    assert spread_of_speech(pairs) <= 1
    assert spread_of_speech(analysed(make("rating", seed=seed), places)) <= 1
    for part in ("long", "short"):
        assert spread_of_speech(trial for trial in ranked if trial.part == part) <= 1


@settings(max_examples=15)
@given(PLACES, SEEDS, st.integers(1, 14))
def test_all_pairs_are_compared_equally_often(places: int, seed: int, trials: int) -> None:
    study = make("all_pairs", seed=seed, trials=trials, practice=0)

    pairs = [frozenset(trial.conditions) for trial in analysed(study, places)]

    assert spread(pairs, study_pairs(study)) <= 1


@given(st.integers(0, 40), SEEDS, st.integers(1, 6), st.integers(1, 12))
def test_nobody_compares_the_same_videos_twice(
    number: int, seed: int, segments: int, trials: int
) -> None:
    study = make("all_pairs", seed=seed, trials=trials, practice=0, catch={"trials": 0})

    plan = study.plan(study.arms[0], number, SEGMENTS[:segments])

    shown = Counter((trial.segment, frozenset(trial.conditions)) for trial in plan)
    assert max(shown.values()) == 1


def study_pairs(study: Study) -> set[frozenset[str]]:
    return {frozenset(pair) for pair in combinations(study.conditions, 2)}


@settings(max_examples=15)
@given(PLACES, SEEDS, st.integers(1, 20), st.integers(1, 20))
def test_a_mismatch_study_shows_every_motion_equally_often(
    places: int, seed: int, fit: int, realism: int
) -> None:
    study = make("mismatch", seed=seed, fit=fit, realism=realism)
    trials = analysed(study, places)
    alone = {frozenset({condition}) for condition in study.conditions}

    for part, shown in (("fit", alone), ("realism", study_pairs(study))):
        of_part = [trial for trial in trials if trial.part == part]
        assert spread((frozenset(trial.conditions) for trial in of_part), shown) <= 1
        for conditions in shown:
            assert spread_of_speech(t for t in of_part if {*t.conditions} == conditions) <= 1


@given(st.sampled_from(sorted(KEYS)), st.integers(0, 60), SEEDS)
def test_with_enough_speech_extra_trials_are_indistinguishable(
    protocol: str, number: int, seed: int
) -> None:
    study = extras(protocol, seed=seed)
    plan = study.plan(study.arms[0], number, SEGMENTS)
    times = Counter(trial.segment for trial in plan)

    for trial in plan:
        if trial.kind in ("catch", "attention"):
            assert times[trial.segment] == 1


@pytest.mark.parametrize("protocol", sorted(KEYS))
def test_extra_trials_have_any_speech_and_position_across_places(protocol: str) -> None:
    study = extras(protocol)
    made = plans(study, 200)
    trials = [trial for plan in made for trial in plan]
    practice = sum(trial.kind == "practice" for trial in made[0])

    for kind in ("catch", "attention"):
        # Catch trials of a mismatch study belong to its second task.
        parts = {trial.part for trial in trials if trial.kind == kind}
        assert parts == ({"realism"} if (protocol, kind) == ("mismatch", "catch") else {*parts})
        possible = {trial.position for trial in trials if trial.part in parts}
        positions = Counter(trial.position for trial in trials if trial.kind == kind)
        heard = Counter(trial.segment.name for trial in trials if trial.kind == kind)
        assert set(positions) == {at for at in possible if at > max(1, practice)}
        assert len(heard) == len(SEGMENTS)
        assert max(heard.values()) < 3 * sum(heard.values()) / len(SEGMENTS)


@pytest.mark.parametrize("protocol", sorted(KEYS))
def test_labels_do_not_reveal_conditions(protocol: str) -> None:
    study = make(protocol, catch={**KEYS[protocol].get("catch", {}), "trials": 0})
    at: Counter[tuple[str, int, str, int]] = Counter()
    for trial in analysed(study, 150):
        if len(set(trial.conditions)) > 1:
            for number, condition in enumerate(trial.conditions):
                at[trial.part, len(trial.conditions), condition, number] += 1

    for (part, size, condition, _), count in at.items():
        of_condition = sum(at[part, size, condition, number] for number in range(size))
        assert abs(count / of_condition - 1 / size) < 0.09


GOLDEN = {
    "adaptive": "08110065d903ee9b",
    "all_pairs": "be61c2b13e08ceef",
    "mismatch": "f1ca222a1b2747a9",
    "pairwise": "edbbb938e775c4cc",
    "ranking": "48aa2efe900b4663",
    "rating": "907c0849dff1d224",
}
"""Digests of one place's trials. A change of plans changes studies that are under way."""


@pytest.mark.parametrize("protocol", sorted(KEYS))
def test_the_same_seed_gives_the_same_trials_on_any_machine(protocol: str) -> None:
    study = extras(protocol, seed=2**31)
    plan = study.plan(study.arms[0], 5, SEGMENTS)
    said = [
        (t.position, t.kind, t.part, t.segment.name, t.videos, t.reference, t.expected)
        for t in plan
    ]

    assert hashlib.sha256(repr(said).encode()).hexdigest()[:16] == GOLDEN[protocol]
