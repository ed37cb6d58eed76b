"""Whoever fails too much leaves the place to somebody else, where the study says so."""

from __future__ import annotations

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession, Trial
from tests.studyapp.session.conftest import Open
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.taking_part_steps import Participant


def arrive(open_changed: Open, *, replace: bool = True, max_failed: int = 0) -> Participant:
    """Return a participant at the first trial of a study with a catch and an attention trial."""
    return (
        open_changed(
            ('name = "tiny"', f'replace_excluded = {str(replace).lower()}\nname = "tiny"'),
            ("[catch]\ntrials = 1", f"[catch]\ntrials = 1\nmax_failed = {max_failed}"),
            added="\n[attention]\ntrials = 1\nmax_failed = 0\n",
        )
        .enrol()
        .begin()
    )


def finish(participant: Participant, *, careless: str = "", left_out: str = "") -> None:
    """Answer everything well, but for the trials of the kinds `careless` and `left_out`."""
    while (shown := participant.look().trial) is not None:
        with participant.database.reading() as session:
            trial = session.scalars(select(Trial).where(Trial.token == shown.token)).one()
        if trial.kind == left_out:
            participant.leave_out()
            continue
        good = trial.instructed or (1 if trial.expected == 2 else -1)
        value = str(-good if trial.kind == careless else good)
        participant.take_trial({"rhythm": value, "emotion": value})


def holders(database: Database) -> int:
    with database.reading() as session:
        taken = select(Place).where(Place.study_session_id.is_not(None))
        return len(session.scalars(taken).all())


@pytest.mark.parametrize("careless", ["catch", "attention"])
def test_who_fails_opens_the_place_again_and_keeps_code_and_answers(
    open_changed: Open, careless: str
) -> None:
    participant = arrive(open_changed)

    finish(participant, careless=careless)

    assert participant.look().state == "completed"
    assert participant.look().completion_code
    assert holders(participant.database) == 0
    assert len(read_once(participant.database, responses_table)) == 14
    participant.another().enrol("next")
    with participant.database.reading() as session:
        numbers = [known.number for known in session.scalars(select(StudySession))]
    assert numbers == [0, 0]
    assert participant.look().state == "completed"


@pytest.mark.parametrize(
    ("replace", "max_failed", "careless"),
    [(True, 0, ""), (True, 0, "main"), (True, 1, "catch"), (False, 0, "catch")],
)
def test_otherwise_the_place_stays_filled(
    open_changed: Open,
    replace: bool,
    max_failed: int,
    careless: str,
) -> None:
    participant = arrive(open_changed, replace=replace, max_failed=max_failed)

    finish(participant, careless=careless)

    assert holders(participant.database) == 1


def test_a_list_without_a_rule_about_failures_keeps_the_place_filled(open_changed: Open) -> None:
    rules = 'replace_excluded = true\nexclusions = [{ rule = "incomplete" }]\n'
    participant = open_changed(('name = "tiny"', f'{rules}name = "tiny"')).enrol().begin()
    finish(participant, careless="catch")
    assert holders(participant.database) == 1
