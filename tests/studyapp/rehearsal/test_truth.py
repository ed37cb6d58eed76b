from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.results.known_values import KnownValue
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.simulation.sight import SeenTrial
from studyapp.rehearsal.simulation.truth import expectations, win_share
from studyapp.study.design.asking import Ask
from studyapp.study.design.pair_trials import PREFERENCES
from studyapp.study.design.stimulus import Stimulus
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.studyapp.made_study import make_segments

SEGMENTS = make_segments(["anger"] * 6)


def counted_share(
    population: Population, *, seed: int, raters: range, other: str, question: str
) -> float:
    """Wins of the reference plus half the ties, as simulated attentive raters really answer."""
    scores = []
    for name in raters:
        rater = Rater(population=population, seed=seed, name=str(name))
        for position, segment in enumerate(SEGMENTS):
            on_the_right = (name + position) % 2 == 1
            left, right = (other, "rule_based") if on_the_right else ("rule_based", other)
            pair = SeenTrial(
                position=position,
                segment=segment.name,
                stimuli=(Stimulus.own(left, segment.name), Stimulus.own(right, segment.name)),
            )
            ask = Ask(question=question, values=PREFERENCES[5])
            answer = rater.prefer(pair, ask) * (1 if on_the_right else -1)
            scores.append((np.sign(answer) + 1) / 2)
    return float(np.mean(scores))


def expected(truth: Sequence[KnownValue], other: str, question: str) -> tuple[float, float]:
    for entry in truth:
        if (entry.about, entry.question) == (f"rule_based-{other}", question):
            return entry.value, entry.on_these_segments
    raise AssertionError("no such comparison")


@pytest.fixture(scope="module")
def attentive(population: Population) -> Population:
    return replace(population, kinds={})


@pytest.mark.parametrize("other", ["mismatched", "static"])
def test_very_many_raters_agree_with_the_share_on_these_segments(
    study: PairwiseStudy, attentive: Population, other: str
) -> None:
    truth = expectations(study, SEGMENTS, population=attentive, seed=4)
    counted = counted_share(attentive, seed=4, raters=range(3000), other=other, question="rhythm")
    assert counted == pytest.approx(expected(truth, other, "rhythm")[1], abs=0.012)


def test_very_many_studies_agree_with_the_share_over_all_segments(
    study: PairwiseStudy, attentive: Population
) -> None:
    counted = [
        counted_share(attentive, seed=seed, raters=range(6), other="static", question="emotion")
        for seed in range(250)
    ]
    truth = expectations(study, SEGMENTS, population=attentive, seed=0)
    error = np.std(counted) / math.sqrt(len(counted))
    assert abs(np.mean(counted) - expected(truth, "static", "emotion")[0]) < 3 * error


def test_luck_of_the_segments_averages_out_over_studies(
    study: PairwiseStudy, attentive: Population
) -> None:
    both = np.array(
        [
            expected(
                expectations(study, SEGMENTS, population=attentive, seed=seed),
                "mismatched",
                "rhythm",
            )
            for seed in range(100)
        ]
    )
    over_all, on_these = both.T
    assert np.ptp(over_all) == 0
    assert on_these.std() > 0.01
    assert on_these.mean() == pytest.approx(over_all[0], abs=3 * on_these.std() / 10)


@given(
    gap=st.floats(-8, 8),
    slope_sd=st.floats(0, 2),
    bias=st.floats(-2, 2),
    bias_sd=st.floats(0, 1),
)
def test_swapping_the_conditions_mirrors_the_share_whatever_the_side_bias(
    gap: float, slope_sd: float, bias: float, bias_sd: float
) -> None:
    population = Population(quality={}, side_bias=bias, side_bias_sd=bias_sd)
    share = win_share(population, gap, slope_sd)
    assert 0 <= share <= 1
    assert share + win_share(population, -gap, slope_sd) == pytest.approx(1)
    assert (share - 0.5) * gap >= -1e-12


@given(gap=st.floats(0.05, 6), slope_sd=st.floats(0, 1.5), more=st.floats(0.05, 2))
def test_a_wider_gap_wins_more_and_disagreement_wins_less(
    gap: float, slope_sd: float, more: float
) -> None:
    population = Population(quality={})
    assert win_share(population, gap + more, slope_sd) > win_share(population, gap, slope_sd)
    assert win_share(population, gap, slope_sd + more) < win_share(population, gap, slope_sd)


def test_a_known_share_is_reproduced_by_hand() -> None:
    """Without any spread: P(y > .5) + P(-.5 < y < .5) / 2 for a logistic around 1."""
    population = Population(quality={}, side_bias=0, side_bias_sd=0, weak=0.5)
    right, not_left = 1 / (1 + math.exp(-0.5)), 1 / (1 + math.exp(-1.5))
    assert win_share(population, 1.0, 0.0) == pytest.approx((right + not_left) / 2)


def test_every_comparison_and_question_has_its_truth(
    study: PairwiseStudy, population: Population
) -> None:
    truth = expectations(study, SEGMENTS, population=population, seed=1)
    assert {(entry.about, entry.question) for entry in truth} == {
        (f"rule_based-{other}", question)
        for other in ("mismatched", "static", "brought")
        for question in ("rhythm", "emotion")
    }
