"""People who leave, come back, hurry or press every button twice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from flask import Flask

from studyapp.database.tables import Place, Response, StudySession
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.resumption import call_roster, let_time_pass
from studyapp.rehearsal.simulation.conduct import Conduct
from studyapp.rehearsal.simulation.kinds import Kind
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.visit import Departure
from studyapp.study.folder import StudyFolder
from tests.studyapp.rehearsal.steps import browser, require_stored_as_acknowledged
from tests.support.stored import opened


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
