from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, SeenTrial
from studyapp.study.design.order import PREFERENCES
from studyapp.study.design.trial import Ask, Stimulus

CONDITIONS = ("a", "b", "flaw")
FAIR = Population(
    quality={"a": {"q": 0.0}, "b": {"q": 0.0}, "flaw": {"q": -6.0}},
    side_bias=0.0,
    kinds={},
    item_sd=0.0,
)


PREFERENCE = Ask(question="q", values=PREFERENCES[5])


def shown(position: int = 0, left: str = "a", right: str = "b") -> SeenTrial:
    segment = f"s{position % 4}"
    return SeenTrial(
        position=position,
        segment=segment,
        stimuli=(Stimulus.own(left, segment), Stimulus.own(right, segment)),
    )


def answers(population: Population, raters: int, trials: int = 4, **sides: str) -> list[int]:
    return [
        Rater(population=population, seed=5, name=str(index)).prefer(
            shown(trial, **sides), PREFERENCE
        )
        for index, trial in product(range(raters), range(trials))
    ]


@settings(max_examples=50)
@given(
    seed=st.integers(0, 2**32 - 1),
    name=st.text(max_size=10),
    left=st.sampled_from(CONDITIONS),
    right=st.sampled_from(CONDITIONS),
    position=st.integers(0, 40),
)
def test_an_answer_depends_on_nothing_but_seed_rater_and_presentation(
    seed: int, name: str, left: str, right: str, position: int
) -> None:
    pair = shown(position, left, right)
    first = Rater(population=FAIR, seed=seed, name=name)
    again = Rater(population=FAIR, seed=seed, name=name)
    again.prefer(shown(position + 1, right, left), PREFERENCE)
    assert first.prefer(pair, PREFERENCE) == again.prefer(pair, PREFERENCE)
    assert first.prefer(pair, PREFERENCE) in range(-2, 3)


@settings(max_examples=50)
@given(seed=st.integers(0, 1000), raising=st.floats(0, 8), position=st.integers(0, 40))
def test_a_better_right_side_never_moves_an_answer_to_the_left(
    seed: int, raising: float, position: int
) -> None:
    better = replace(FAIR, quality={"a": {"q": 0.0}, "b": {"q": raising}})
    before = Rater(population=FAIR, seed=seed, name="r").prefer(shown(position), PREFERENCE)
    after = Rater(population=better, seed=seed, name="r").prefer(shown(position), PREFERENCE)
    assert after >= before


def test_equal_conditions_are_answered_evenly() -> None:
    values = np.array(answers(FAIR, 600))
    assert abs(values.mean()) < 0.1
    counts = Counter(values.tolist())
    assert counts[-1] + counts[1] > counts[0] > 0.1 * len(values)
    assert counts[2] == pytest.approx(counts[-2], rel=0.25)


@pytest.mark.parametrize("bias", [-0.8, 0.8])
def test_side_bias_pulls_towards_its_side_whatever_is_shown(bias: float) -> None:
    population = replace(FAIR, side_bias=bias)
    for left, right in (("a", "b"), ("b", "a")):
        assert np.mean(answers(population, 300, left=left, right=right)) * np.sign(bias) > 0.25


def test_an_attentive_rater_sees_a_visible_flaw_on_either_side() -> None:
    assert np.mean(np.array(answers(FAIR, 300, left="a", right="flaw")) < 0) > 0.98
    assert np.mean(np.array(answers(FAIR, 300, left="flaw", right="a")) > 0) > 0.98


def test_raters_and_segments_differ_by_the_stated_standard_deviations() -> None:
    population = replace(FAIR, item_sd=0.45)

    def gap(rater: str, segment: str) -> float:
        person = Rater(population=population, seed=1, name=rater)
        return person.utility(Stimulus.own("a", segment), "q") - person.utility(
            Stimulus.own("b", segment), "q"
        )

    over_raters = np.std([gap(str(index), "s") for index in range(3000)])
    over_segments = np.std([gap("r", str(index)) for index in range(3000)])
    assert over_raters == pytest.approx(population.participant_sd, rel=0.05)
    assert over_segments == pytest.approx(population.item_sd, rel=0.05)
