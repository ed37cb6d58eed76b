"""Simulated answers to trials as every protocol plans them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from flask import Flask

from studyapp.database.tables import Place, Response, StudySession
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.resumption import call_roster, let_time_pass
from studyapp.rehearsal.simulation.judgement import Conduct, Judgement, judge
from studyapp.rehearsal.simulation.population import Kind, Population, default_population
from studyapp.rehearsal.simulation.raters import Rater, SeenTrial
from studyapp.rehearsal.visit import Departure
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study
from tests.studyapp.made_study import make_segments
from tests.studyapp.rehearsal.protocol_studies import definition
from tests.studyapp.rehearsal.steps import browser, require_stored_as_acknowledged
from tests.support.stored import opened

SEGMENTS = make_segments(["anger", "fear", "sadness"])
ATTENTIVE: dict[str, Any] = {"kinds": {}, "overlooked": 0.0}
STUDIES = {
    name: parse_text(definition(name, around=False), where="study.toml")
    for name in ("all pairs", "ratings", "rankings", "rankings with ties", "mismatch")
}
each_study = pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES.keys())


def judged(
    study: Study, raters: int = 40, **people: Any
) -> Iterator[tuple[Rater, SeenTrial, Judgement]]:
    """Yield what raters answer to all trials of their places."""
    population: Population = replace(default_population(study), **people)
    for number in range(raters):
        rater = Rater(population=population, seed=6, name=str(number))
        for planned in study.plan(study.arms[0], number % study.arms[0].places, SEGMENTS):
            trial = SeenTrial(
                position=planned.position,
                kind=planned.kind,
                part=planned.part,
                segment=planned.segment.name,
                stimuli=planned.stimuli,
                expected=planned.expected,
                instructed=planned.instructed,
            )
            yield rater, trial, judge(study, rater, trial)


@each_study
@pytest.mark.parametrize(
    "kind", ["attentive", "careless", "hasty", "side_biased", "straight_lining"]
)
def test_every_answer_is_one_that_the_study_takes(study: Study, kind: Kind) -> None:
    for _, trial, judgement in judged(study, kinds={kind: 1.0}):
        asks = study.asks(trial)
        assert set(judgement.values) == {ask.key for ask in asks}
        assert all(judgement.values[ask.key] in ask.values for ask in asks)
        assert not study.problem(trial, judgement.values)
        assert set(judgement.fields()) >= {ask.field for ask in asks}


@each_study
def test_attentive_raters_do_what_attention_checks_ask(study: Study) -> None:
    checks = [
        study.failed(trial, judgement.values)
        for _, trial, judgement in judged(study, **ATTENTIVE)
        if trial.instructed is not None
    ]
    assert not any(checks)


@each_study
def test_a_check_that_is_overlooked_is_answered_as_any_other_page(study: Study) -> None:
    checked = [
        (judgement.values, judge(study, rater, replace(trial, instructed=None)).values)
        for rater, trial, judgement in judged(study, kinds={}, overlooked=1.0)
        if trial.instructed is not None
    ]
    assert all(answered == ordinary for answered, ordinary in checked)


@pytest.mark.parametrize("protocol", ["all pairs", "ratings", "mismatch", "rankings with ties"])
@pytest.mark.parametrize("kind", ["careless", "hasty", "straight_lining"])
def test_unsound_raters_fail_some_attention_checks(protocol: str, kind: Kind) -> None:
    study = STUDIES[protocol]
    failed = [
        study.failed(trial, judgement.values)
        for _, trial, judgement in judged(study, kinds={kind: 1.0})
        if trial.instructed is not None
    ]
    assert sum(failed) > len(failed) / 10


@each_study
def test_who_answers_in_a_straight_line_always_says_the_same(study: Study) -> None:
    lines: dict[tuple[str, int, object], set[int]] = {}
    for rater, trial, judgement in judged(study, kinds={"straight_lining": 1.0}):
        for key, value in judgement.values.items():
            lines.setdefault((rater.name, len(trial.stimuli), key), set()).add(value)
    assert all(len(values) == 1 for values in lines.values())


@each_study
def test_who_is_side_biased_is_drawn_to_one_end_of_the_page(study: Study) -> None:
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


def test_who_is_hasty_sees_less_of_every_difference() -> None:
    study = STUDIES["all pairs"]
    right = {
        kind: [
            study.prefers(judgement.values, trial.expected, 3 - trial.expected)
            for _, trial, judgement in judged(study, kinds={kind: 1.0})
            if trial.expected is not None
        ]
        for kind in ("attentive", "hasty", "careless")
    }
    share = {kind: sum(found) / len(found) for kind, found in right.items()}
    assert share["attentive"] > share["hasty"] > share["careless"]


def test_reasons_are_ticked_as_often_as_the_population_says() -> None:
    ticked = [
        len(judgement.reasons[ask.key]) / len(ask.reasons)
        for _, _, judgement in judged(STUDIES["ratings"], 160, reasons=0.4)
        for ask in judgement.asks
        if ask.reasons
    ]
    assert sum(ticked) / len(ticked) == pytest.approx(0.4, abs=0.05)


def test_motion_is_preferred_with_its_own_speech_where_it_belongs_to_it() -> None:
    study = STUDIES["mismatch"]
    wins: dict[bool, list[bool]] = {True: [], False: []}
    people = default_population(study)
    strong = {name: {"better": 4.0 if name == "ours" else 0.0} for name in people.quality}
    for _, trial, judgement in judged(study, belonging=strong, **ATTENTIVE):
        if trial.part == "fit":
            own = next(n for n, s in enumerate(trial.stimuli) if s.speech == s.segment)
            value = judgement.values["better", None]
            wins[trial.conditions[0] == "ours"].append(value == (1 if own else -1))
    assert sum(wins[True]) > 0.8 * len(wins[True])
    assert sum(wins[False]) < 0.6 * len(wins[False])


def conduct(kind: Kind, name: str = "a", trials: int = 10, coverage: float = 0.95) -> Conduct:
    population = Population(quality={}, kinds={kind: 1.0})
    rater = Rater(population=population, seed=1, name=name)
    return Conduct(rater=rater, trials=trials, coverage=coverage)


@pytest.fixture
def ledger(tmp_path: Path) -> Ledger:
    return Ledger(tmp_path / "told" / "acknowledged.jsonl")


def being(participant: Participant, kind: Kind, ledger: Ledger) -> Participant:
    """Return a participant who is certainly of `kind`."""
    people = replace(participant.population, kinds={kind: 1.0})
    return replace(participant, population=people, ledger=ledger)


def test_who_leaves_does_so_at_any_trial_and_others_stay() -> None:
    for kind in ("dropping_out", "returning"):
        left_at = {conduct(kind, str(number), trials=4).leaves_at for number in range(60)}
        assert left_at == {1, 2, 3, 4}
    assert conduct("attentive").leaves_at is None
    assert conduct("returning").returns
    assert not conduct("dropping_out").returns


def test_who_is_hasty_watches_as_little_as_may_be_and_answers_sooner() -> None:
    assert conduct("attentive").watches == 1.0
    assert conduct("hasty").watches == pytest.approx(0.96)
    assert conduct("hasty", coverage=1.0).watches == 1.0
    slowest = max(conduct("hasty").thinks(position) for position in range(20))
    assert slowest < min(conduct("attentive").thinks(position) for position in range(20))


def test_who_drops_out_leaves_what_was_answered_and_opens_the_place_for_another(
    app: Flask, participant: Participant, ledger: Ledger, folder: StudyFolder
) -> None:
    person = being(participant, "dropping_out", ledger)
    truth = Truth(seed=participant.seed, study="", population=person.population, expected=())
    with opened(folder.rehearsal) as database:
        with browser(app) as client, pytest.raises(Departure) as departure:
            replace(person, name="rehearsal-00000", eyes=Eyes(database)).take_part(client)
        assert not departure.value.returns
        roster = call_roster(database, 6, truth)
        assert roster.gone == ("rehearsal-00000",)
        assert roster.wanted == 7
        let_time_pass(database, roster, participant.study.lease_minutes)
        with browser(app) as client:
            replace(participant, name="other", eyes=Eyes(database)).take_part(client)
        with database.reading() as session:
            gone, other = session.query(StudySession).order_by(StudySession.id)
            assert gone.place is None
            assert gone.completed_at is None
            shown = [trial.shown_at for trial in gone.trials if trial.shown_at]
            assert gone.consented_at <= min(shown)
            assert max(shown) <= gone.last_active_at < other.consented_at
            assert isinstance(other.place, Place)
            stored = session.query(Response).filter(
                Response.trial_id.in_(t.id for t in gone.trials)
            )
            assert stored.count() == len(ledger.read().answers)


def test_who_comes_back_goes_on_where_they_left_and_everything_is_stored_once(
    app: Flask, participant: Participant, ledger: Ledger, eyes: Eyes
) -> None:
    person = being(participant, "returning", ledger)
    with browser(app) as client, pytest.raises(Departure) as departure:
        person.take_part(client)
    assert departure.value.returns
    with browser(app) as client:
        code = person.take_part(client, is_back=True)
    assert ledger.read().codes == {person.name: code}
    require_stored_as_acknowledged(eyes.database, ledger)


def test_who_presses_everything_twice_takes_part_once(
    app: Flask, participant: Participant, ledger: Ledger, eyes: Eyes
) -> None:
    person = being(participant, "double_clicking", ledger)
    with browser(app) as client:
        assert person.take_part(client)
    require_stored_as_acknowledged(eyes.database, ledger)


def test_who_is_hasty_passes_what_must_be_watched_and_no_more(
    app: Flask, participant: Participant, ledger: Ledger, eyes: Eyes
) -> None:
    with browser(app) as client:
        assert being(participant, "hasty", ledger).take_part(client)
    require_stored_as_acknowledged(eyes.database, ledger)
