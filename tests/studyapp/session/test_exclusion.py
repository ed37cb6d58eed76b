"""A participant who fails too many checks frees the place, if the study says so."""

from __future__ import annotations

import pytest
from sqlalchemy import select

from studyapp.database.tables import StudySession, Trial
from tests.studyapp.session.conftest import Open, held_places
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.taking_part_steps import Participant

REPLACING = ('name = "tiny"', 'replace_excluded = true\nname = "tiny"')
STRICT = ("[catch]\n", "[catch]\nmax_failed = 0\n")
FORGIVING = ("[catch]\n", "[catch]\nmax_failed = 1\n")
OTHER_RULES = ('name = "tiny"', 'exclusions = [{ rule = "incomplete" }]\nname = "tiny"')
ATTENTION = "\n[attention]\ntrials = 1\nmax_failed = 0\n"

Change = tuple[str, str]


def finish(
    open_changed: Open, careless: str, *changes: Change, added: str = "", skip: bool = False
) -> Participant:
    """Take part in the changed study, and fail the trials of the kind `careless`, or skip them."""
    participant = open_changed(*changes, added=added).enrol().begin()
    while (shown := participant.look().trial) is not None:
        with participant.database.reading() as session:
            trial = session.scalars(select(Trial).where(Trial.token == shown.token)).one()
        good = trial.instructed or (1 if trial.expected == 2 else -1)
        if trial.kind == careless and skip:
            participant.leave_out()
            continue
        value = str(-good if trial.kind == careless else good)
        participant.take_trial({"rhythm": value, "emotion": value})
    return participant


@pytest.mark.parametrize("careless", ["catch", "attention"])
def test_failing_frees_the_place_and_keeps_code_and_answers(
    open_changed: Open, careless: str
) -> None:
    participant = finish(open_changed, careless, REPLACING, STRICT, added=ATTENTION)

    assert participant.look().state == "completed"
    assert participant.look().completion_code
    assert held_places(participant.database) == 0
    assert len(read_once(participant.database, responses_table)) == 14
    participant.another().enrol("next")
    with participant.database.reading() as session:
        assert session.scalars(select(StudySession.number)).all() == [0, 0]


def test_a_skipped_catch_trial_is_failed(open_changed: Open) -> None:
    participant = finish(open_changed, "catch", REPLACING, STRICT, skip=True)

    assert held_places(participant.database) == 0


@pytest.mark.parametrize(
    ("changes", "careless"),
    [
        ((REPLACING, STRICT), ""),
        ((REPLACING, STRICT), "main"),
        ((REPLACING, FORGIVING), "catch"),
        ((STRICT,), "catch"),
        ((REPLACING, OTHER_RULES), "catch"),
    ],
)
def test_other_exclusions_keep_the_place_filled(
    open_changed: Open, changes: tuple[Change, ...], careless: str
) -> None:
    assert held_places(finish(open_changed, careless, *changes).database) == 1
