"""The people of a rehearsal, and their answers to trials as every protocol plans them."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from flask import Flask
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import select

from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Departure, Participant
from studyapp.rehearsal.simulation.population import Kind, Population, default_population, ranks
from studyapp.rehearsal.simulation.raters import Judgement, Rater, judge
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.rehearsal import Rehearsal
from studyapp.study.settings.study import Study
from tests.studyapp.rehearsal.protocol_studies import definition
from tests.studyapp.rehearsal.steps import browser
from tests.support.studies.made_study import make_segments

SEGMENTS = make_segments(["anger", "fear", "sadness"])
STUDIES = {
    name: parse_text(definition(name), where="study.toml")
    for name in ("all pairs", "ratings", "rankings", "rankings with ties", "mismatch")
}
each_study = pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES.keys())


def judged(
    study: Study, raters: int = 40, **people: Any
) -> Iterator[tuple[Rater, PlannedTrial, Judgement]]:
    """Yield what raters answer to all trials of their places."""
    population: Population = replace(default_population(study), **people)
    for number in range(raters):
        rater = Rater(population=population, seed=6, name=str(number))
        for trial in study.plan(study.arms[0], number % study.arms[0].places, SEGMENTS):
            yield rater, trial, judge(study, rater, trial)


@each_study
@pytest.mark.parametrize(
    "kind", ["attentive", "careless", "hasty", "side_biased", "straight_lining"]
)
def test_every_simulated_answer_is_valid(study: Study, kind: Kind) -> None:
    for _, trial, judgement in judged(study, kinds={kind: 1.0}):
        asks = study.asks(trial)
        assert set(judgement.values) == {ask.key for ask in asks}
        assert all(judgement.values[ask.key] in ask.values for ask in asks)
        assert not study.problem(trial, judgement.values)
        assert set(judgement.fields()) >= {ask.field for ask in asks}


@each_study
@pytest.mark.parametrize("overlooked", [0.0, 1.0])
def test_attention_checks_are_followed_or_answered_like_other_pages(
    study: Study, overlooked: float
) -> None:
    for rater, trial, judgement in judged(study, kinds={}, overlooked=overlooked):
        if trial.instructed is not None:
            ordinary = judge(study, rater, replace(trial, instructed=None)).values
            if overlooked:
                assert judgement.values == ordinary
            else:
                assert not study.failed(trial, judgement.values)


@each_study
def test_straight_lining_raters_always_give_the_same_answer(study: Study) -> None:
    lines: dict[tuple[str, int, object], set[int]] = {}
    for rater, trial, judgement in judged(study, kinds={"straight_lining": 1.0}):
        for key, value in judgement.values.items():
            lines.setdefault((rater.name, len(trial.stimuli), key), set()).add(value)
    assert all(len(values) == 1 for values in lines.values())


@each_study
def test_side_biased_raters_prefer_one_end_of_the_page(study: Study) -> None:
    """By the sum over raters of how far each leans, whichever way."""

    def leaning(kind: Kind) -> float:
        leans: dict[str, float] = {}
        for rater, trial, judgement in judged(study, kinds={kind: 1.0}):
            last = len(trial.stimuli)
            for (_, number), value in judgement.values.items():
                towards_last = value if number is None else {1: -value, last: value}.get(number, 0)
                leans[rater.name] = leans.get(rater.name, 0.0) + towards_last
        return sum(map(abs, leans.values()))

    assert leaning("side_biased") > 1.3 * leaning("attentive")


@pytest.mark.parametrize("kind", ["returning", "double_clicking", "hasty"])
def test_every_answer_of_every_kind_of_participant_is_stored_once(
    app: Flask, participant: Participant, eyes: Eyes, kind: Kind
) -> None:
    people = replace(participant.population, kinds={kind: 1.0})
    person = replace(participant, population=people)
    is_back = kind == "returning"
    if is_back:
        with browser(app) as client, pytest.raises(Departure) as departure:
            person.take_part(client)
        assert departure.value.returns
    with browser(app) as client:
        code = person.take_part(client, is_back=is_back)
    acknowledged = person.ledger.read()
    assert acknowledged.codes == {person.name: code}
    assert acknowledged.left == acknowledged.returned == ({person.name} if is_back else set())
    with eyes.database.reading() as session:
        assert session.scalars(select(StudySession.completed_at)).one() is not None
        stored = [
            ((trial.token, response.question, response.stimulus or 0), response.value)
            for trial in session.scalars(select(Trial))
            for response in trial.responses
        ]
    assert len(stored) == len(acknowledged.answers) > 0
    assert dict(stored) == acknowledged.answers


def test_stated_values_replace_defaults_and_a_star_stands_for_all_other_questions(
    study: PairwiseStudy,
) -> None:
    stated = Rehearsal.model_validate(
        {
            "careless": 0.2,
            "hasty": 0,
            "segments_differ": 0.1,
            "strength": {
                "rule_based": 2,
                "static": {"emotion": -0.25},
                "brought": {"emotion": 0.25, "*": -1},
            },
            "own_speech": {"rule_based": {"rhythm": 0.4}},
        }
    )
    people = default_population(study.model_copy(update={"rehearsal": stated}))
    assert people.quality["rule_based"] == {"rhythm": 2, "emotion": 2}
    assert people.quality["static"] == {"rhythm": -1.0, "emotion": -0.25}
    assert people.quality["brought"] == {"rhythm": -1, "emotion": 0.25}
    assert people.quality["mismatched"] == default_population(study).quality["mismatched"]
    assert people.belonging["rule_based"] == {"rhythm": 0.4, "emotion": 3.0}
    assert (people.kinds["careless"], people.kinds["hasty"], people.item_sd) == (0.2, 0.0, 0.1)


@given(utilities=st.lists(st.floats(-9, 9), min_size=2, max_size=8), within=st.floats(0, 5))
def test_tied_ranks_skip_no_rank_and_keep_the_order(utilities: list[float], within: float) -> None:
    found = ranks(utilities, tie_within=within)
    assert set(found) == set(range(1, max(found) + 1))
    assert sorted(ranks(utilities)) == list(range(1, len(utilities) + 1))
    for a, b in zip(utilities, found, strict=True):
        for c, d in zip(utilities, found, strict=True):
            assert (a <= c) or b <= d
            assert b != d or abs(a - c) <= within
