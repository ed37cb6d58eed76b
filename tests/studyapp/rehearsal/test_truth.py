from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.results.headline import Measure
from analysis.results.known_values import KnownValue
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, SeenTrial
from studyapp.rehearsal.simulation.truth import (
    expectations,
    win_share,
)
from studyapp.study.design.order import PREFERENCES
from studyapp.study.design.trial import Ask, Stimulus
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study
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
        for seed in range(500)
    ]
    truth = expectations(study, SEGMENTS, population=attentive, seed=0)
    error = np.std(counted) / math.sqrt(len(counted))
    assert abs(np.mean(counted) - expected(truth, "static", "emotion")[0]) < 3 * error


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


CONDITIONS = ("ours", "theirs", "real")
THREE = make_segments(["anger"] * 3)
RATERS = 700
PEOPLE = Population(
    quality={"ours": {"q": 0.8}, "theirs": {"q": 0.0}, "real": {"q": 1.6}},
    belonging={"ours": {"q": 1.0}, "theirs": {"q": 0.0}, "real": {"q": 2.0}},
    kinds={},
)
KEYS = {
    "name": "made",
    "title": "Made",
    "conditions": {name: {"videos": True} for name in CONDITIONS},
    "page": {"consent": "You agree."},
}
QUESTION = {"name": "q", "title": "Q", "text": "?"}


def known(study: Study, measure: Measure) -> dict[str, KnownValue]:
    found = expectations(study, THREE, population=PEOPLE, seed=3)
    return {entry.about: entry for entry in found if entry.measure == measure}


def shown(*stimuli: Stimulus, position: int) -> SeenTrial:
    return SeenTrial(position=position, segment=stimuli[0].segment, stimuli=stimuli)


def raters() -> list[Rater]:
    return [Rater(population=PEOPLE, seed=3, name=str(number)) for number in range(RATERS)]


@pytest.mark.parametrize("scale", ["mean_opinion", "slider"])
def test_very_many_ratings_average_to_the_mean_on_these_segments(scale: str) -> None:
    study = RatingStudy.model_validate(
        KEYS
        | {
            "sets": [{"name": "all", "conditions": CONDITIONS}],
            "questions": [QUESTION | {"scale": scale}],
        }
    )
    values = study.questions[0].values
    truth = known(study, "mean_rating")
    for condition in CONDITIONS:
        answers = [
            rater.rate(
                shown(Stimulus.own(condition, segment.name), position=position),
                Ask(question="q", stimulus=1, values=values),
            )
            for rater, (position, segment) in product(raters(), enumerate(THREE))
        ]
        error = np.std(answers) / math.sqrt(RATERS)
        assert abs(np.mean(answers) - truth[condition].on_these_segments) < 3 * error


def test_very_many_rankings_average_to_the_mean_on_these_segments() -> None:
    study = RankingStudy.model_validate(
        KEYS | {"blocks": [{"name": "all", "conditions": CONDITIONS}], "questions": [QUESTION]}
    )
    truth = known(study, "mean_rank")
    found = np.array(
        [
            rater.rank(
                shown(*(Stimulus.own(c, segment.name) for c in CONDITIONS), position=position),
                "q",
                ties=False,
            )
            for rater, (position, segment) in product(raters(), enumerate(THREE))
        ]
    )
    means = dict(zip(CONDITIONS, found.mean(axis=0), strict=True))
    assert means["real"] < means["ours"] < means["theirs"]
    for condition, mean in means.items():
        assert mean == pytest.approx(truth[condition].on_these_segments, abs=0.07)


@pytest.mark.parametrize("levels", [2, 3])
def test_very_many_answers_prefer_the_own_speech_as_often_as_computed(levels: int) -> None:
    study = MismatchStudy.model_validate(
        KEYS | {"questions": [QUESTION | {"levels": levels}], "realism": 1}
    )
    truth = known(study, "own_speech")
    for condition in CONDITIONS:
        scores = []
        for rater, (position, segment) in product(raters(), enumerate(THREE)):
            own = Stimulus.own(condition, segment.name)
            pair = (own, replace(own, speech="elsewhere"))
            own_first = (int(rater.name) + position) % 2 == 0
            trial = shown(*(pair if own_first else pair[::-1]), position=position)
            (ask,) = study.asks(trial)
            answer = rater.prefer(trial, ask) * (-1 if own_first else 1)
            scores.append((np.sign(answer) + 1) / 2)
        assert np.mean(scores) == pytest.approx(truth[condition].on_these_segments, abs=0.04)


def test_nothing_is_expected_of_shared_ranks() -> None:
    study = RankingStudy.model_validate(
        KEYS
        | {
            "ties": True,
            "blocks": [{"name": "all", "conditions": CONDITIONS}],
            "questions": [QUESTION],
        }
    )
    assert expectations(study, THREE, population=PEOPLE, seed=3) == ()
