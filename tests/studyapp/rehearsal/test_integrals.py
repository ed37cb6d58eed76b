"""What is computed of very many raters is what very many raters answer."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.results.headline import Measure
from analysis.results.known_values import KnownValue
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.simulation.sight import SeenTrial
from studyapp.rehearsal.simulation.truth import averaged, expectations, mean_rank, mean_rating
from studyapp.study.design.asking import Ask
from studyapp.study.design.stimulus import Stimulus
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study
from tests.studyapp.made_study import make_segments

CONDITIONS = ("ours", "theirs", "real")
SEGMENTS = make_segments(["anger"] * 3)
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


def expected(study: Study, measure: Measure) -> dict[str, KnownValue]:
    found = expectations(study, SEGMENTS, population=PEOPLE, seed=3)
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
    truth = expected(study, "mean_rating")
    for condition in CONDITIONS:
        answers = [
            rater.rate(
                shown(Stimulus.own(condition, segment.name), position=position),
                Ask(question="q", stimulus=1, values=values),
            )
            for rater, (position, segment) in product(raters(), enumerate(SEGMENTS))
        ]
        error = np.std(answers) / math.sqrt(RATERS)
        assert abs(np.mean(answers) - truth[condition].on_these_segments) < 3 * error


def test_very_many_rankings_average_to_the_mean_on_these_segments() -> None:
    study = RankingStudy.model_validate(
        KEYS | {"blocks": [{"name": "all", "conditions": CONDITIONS}], "questions": [QUESTION]}
    )
    truth = expected(study, "mean_rank")
    found = np.array(
        [
            rater.rank(
                shown(*(Stimulus.own(c, segment.name) for c in CONDITIONS), position=position),
                "q",
                ties=False,
            )
            for rater, (position, segment) in product(raters(), enumerate(SEGMENTS))
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
    truth = expected(study, "own_speech")
    for condition in CONDITIONS:
        scores = []
        for rater, (position, segment) in product(raters(), enumerate(SEGMENTS)):
            own = Stimulus.own(condition, segment.name)
            pair = (own, replace(own, speech="elsewhere"))
            own_first = (int(rater.name) + position) % 2 == 0
            trial = shown(*(pair if own_first else pair[::-1]), position=position)
            (ask,) = study.asks(trial)
            answer = rater.prefer(trial, ask) * (-1 if own_first else 1)
            scores.append((np.sign(answer) + 1) / 2)
        assert np.mean(scores) == pytest.approx(truth[condition].on_these_segments, abs=0.04)


def test_motion_that_belongs_nowhere_is_preferred_with_neither_speech() -> None:
    study = MismatchStudy.model_validate(KEYS | {"questions": [QUESTION]})
    assert expected(study, "own_speech")["theirs"].value == pytest.approx(0.5)


def test_nothing_is_expected_of_shared_ranks() -> None:
    study = RankingStudy.model_validate(
        KEYS
        | {
            "ties": True,
            "blocks": [{"name": "all", "conditions": CONDITIONS}],
            "questions": [QUESTION],
        }
    )
    assert expectations(study, SEGMENTS, population=PEOPLE, seed=3) == ()


@given(utilities=st.lists(st.floats(-5, 5), min_size=2, max_size=8), sd=st.floats(0, 2))
def test_mean_ranks_share_out_the_ranks_that_there_are(utilities: list[float], sd: float) -> None:
    count = len(utilities)
    means = [
        mean_rank([own - other for i, other in enumerate(utilities) if i != index], sd)
        for index, own in enumerate(utilities)
    ]
    assert sum(means) == pytest.approx(count * (count + 1) / 2)
    assert all(1 <= mean <= count for mean in means)


@given(quality=st.floats(-8, 8), more=st.floats(0.1, 2), spread=st.floats(0, 2))
def test_a_better_condition_has_the_better_mean_rating(
    quality: float, more: float, spread: float
) -> None:
    lower, higher = (
        mean_rating(PEOPLE, worth, spread, range(1, 6)) for worth in (quality, quality + more)
    )
    assert 1 <= lower < higher <= 5
    assert mean_rating(PEOPLE, -quality, spread, range(1, 6)) == pytest.approx(6 - lower)


def test_an_average_over_nothing_is_the_value_itself() -> None:
    assert averaged(np.cos, 0.4, 0.0) == pytest.approx(math.cos(0.4))
    assert averaged(np.square, 1.0, 2.0) == pytest.approx(5.0)
