from __future__ import annotations

from dataclasses import replace

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
