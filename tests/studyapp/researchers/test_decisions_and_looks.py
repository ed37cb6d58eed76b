"""Decisions about participants and looks at results: what is kept of them, and what they leave."""

import pytest
from sqlalchemy import select, update

from motion.errors import InputError
from studyapp.custody.forgetting import erase
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import AuditLine, ExclusionDecision
from studyapp.researchers.audit import ERASED, StudyState, latest_changes, log_look
from studyapp.researchers.exclusion_decisions import (
    current_exclusions,
    decide_exclusion,
    exclusion_decisions,
)
from studyapp.results.stored_answers import stored_answers
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import Participant, SetClock


def exclude(database: Database, clock: SetClock, number: int, reason: str = "asleep") -> None:
    decide_exclusion(database, clock, number, excluded=True, by="Ada", reason=reason)


def reinstate(database: Database, clock: SetClock, number: int) -> None:
    decide_exclusion(database, clock, number, excluded=False, by="Charles", reason="awake")


def excluded(database: Database) -> dict[int, str]:
    with database.reading() as session:
        return {number: reason for number, reason, _ in session.execute(current_exclusions())}


@BOTH
def test_the_newest_decision_holds_and_none_is_lost(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    for name in ("one", "two", "three"):
        Participant(opened, served, clock).enrol(name).begin()
    exclude(opened, clock, 1, "  fell\n asleep ")
    exclude(opened, clock, 2)
    reinstate(opened, clock, 2)
    exclude(opened, clock, 3, "first")
    reinstate(opened, clock, 3)
    exclude(opened, clock, 3, "second")

    assert excluded(opened) == {1: "fell asleep", 3: "second"}
    decisions = read_once(opened, exclusion_decisions, 3)
    assert [each.reason for each in decisions] == ["second", "awake", "first"]
    assert len(latest_changes(opened)) == 6
    kept = read_once(opened, stored_answers).study_sessions
    assert kept["excluded_because"].tolist() == ["fell asleep", "", "second"]
    assert kept["excluded_after_look"].tolist() == [False, False, False]

    # Exclusions after a look at results are marked.
    clock.advance(seconds=1)
    with opened.writing() as session:
        state = StudyState(finished=0, planned=4, answers=0)
        log_look(session, clock.now(), state, way="page", by="Ada", reason="curious")
    clock.advance(seconds=1)
    exclude(opened, clock, 2)
    kept = read_once(opened, stored_answers).study_sessions
    assert kept["excluded_after_look"].tolist() == [False, True, False]


def test_an_impossible_decision_changes_nothing(participant: Participant, clock: SetClock) -> None:
    database = participant.database
    participant.another().enrol("gone").withdraw()
    before = len(latest_changes(database))

    for reason in ("", " \n", "x" * 501, "a\0b", "a\udc80b"):
        with pytest.raises(InputError, match="reason of 1 to 500"):
            exclude(database, clock, 1, reason)
    with pytest.raises(InputError, match="1 is not excluded by hand"):
        reinstate(database, clock, 1)
    with pytest.raises(InputError, match="no study session 77"):
        exclude(database, clock, 77)
    with pytest.raises(InputError, match="has withdrawn"):
        exclude(database, clock, 2)

    assert excluded(database) == {}
    assert len(latest_changes(database)) == before
    exclude(database, clock, 1)
    with pytest.raises(InputError, match="1 is already excluded by hand"):
        exclude(database, clock, 1)
    assert len(read_once(database, exclusion_decisions, 1)) == 1


@pytest.mark.parametrize("leaves", ["withdrawn", "forgotten"])
def test_withdrawing_also_deletes_the_reason_for_an_exclusion(
    participant: Participant, clock: SetClock, leaves: str
) -> None:
    database = participant.database
    participant.another().enrol("other")
    exclude(database, clock, 1, "wrote that she is ill")
    exclude(database, clock, 2, "plays at double speed")
    with database.writing() as session:
        session.execute(update(AuditLine).values(detail="worded in another way"))

    if leaves == "withdrawn":
        participant.withdraw()
    else:
        with database.writing() as session:
            erase(session, find_study_session(session, participant.token), None, clock.now())

    assert excluded(database) == {2: "plays at double speed"}
    with database.reading() as session:
        assert len(session.scalars(select(ExclusionDecision)).all()) == 1
        reasons = session.scalars(select(AuditLine.reason)).all()
    assert ERASED in reasons
    assert "plays at double speed" in reasons
    assert not any("ill" in reason for reason in reasons)
