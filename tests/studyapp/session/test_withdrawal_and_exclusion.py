"""Participants who withdraw or fail too many checks: their data, and their place."""

from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import FormAnswer, RefusalLine, StudySession
from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord
from studyapp.session.ending import withdrawal_promise
from studyapp.session.enrolment import Arrival
from studyapp.session.refusal import ConflictError, log_refusal
from studyapp.session.served_study import ServedStudy
from tests.studyapp.session.conftest import Open, held_places
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.form_questions import ADULT, ELIGIBILITY
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant

ABOUT_THEM = (Trial, TrialStimulus, Video, WatchRecord, Response, FormAnswer, RefusalLine)
RECRUITED = Arrival(
    recruiter_participant="p1", recruiter_study="s1", recruiter_session="x1", form=ADULT
)


@pytest.fixture
def begun(open_changed: Open) -> Participant:
    """Return a recruited participant of a study that promises to delete withdrawn answers."""
    promise = ("[page]\n", '[page]\nwithdrawn = "deleted"\n')
    return take_part(open_changed(promise, added=ELIGIBILITY), RECRUITED)


def take_part(participant: Participant, arrival: Arrival) -> Participant:
    """Let a participant answer a trial, and cause one refusal."""
    participant.arrive(arrival).begin().take_trial()
    refusal = ConflictError("No.", "Try again.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)
    return participant


def counts(database: Database) -> list[int]:
    return [len(found_in(database, select(table.id))) for table in ABOUT_THEM]


def test_promised_deletion_leaves_no_data(begun: Participant) -> None:
    database = begun.database
    before = counts(database)
    other = take_part(begun.another(), Arrival(visit="other", form=ADULT))

    begun.withdraw()

    assert counts(database) == before
    assert (begun.look().state, begun.look().presentations) == ("withdrawn", 0)
    left = begun.stored()
    assert left.withdrawn_at is not None
    assert (left.recruiter_participant, left.recruiter_session) == ("p1", "")
    assert (left.conditions, left.number, left.started_at) == ([], None, None)
    assert other.trial().position == 2
    assert len(read_once(database, responses_table)) == 2


def test_the_withdrawal_rule_at_consent_holds_after_the_study_changes_it(
    begun: Participant, tiny_study: Path
) -> None:
    redefine(tiny_study, ('withdrawn = "deleted"', 'withdrawn = "kept"'))
    begun.in_study(ServedStudy.read(tiny_study), new_version=True)

    assert withdrawal_promise(begun.database, begun.token) == "deleted"
    begun.withdraw()

    assert set(counts(begun.database)) == {0}


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
        query = select(Trial).where(Trial.token == shown.token)
        (trial,) = found_in(participant.database, query)
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
    assert found_in(participant.database, select(StudySession.number)) == [0, 0]


@pytest.mark.parametrize(
    ("changes", "careless", "skip", "held"),
    [
        ((REPLACING, STRICT), "catch", True, 0),
        ((REPLACING, STRICT), "", False, 1),
        ((REPLACING, STRICT), "main", False, 1),
        ((REPLACING, FORGIVING), "catch", False, 1),
        ((STRICT,), "catch", False, 1),
        ((REPLACING, OTHER_RULES), "catch", False, 1),
    ],
)
def test_a_skipped_check_is_failed_and_other_exclusions_keep_the_place_filled(
    open_changed: Open, changes: tuple[Change, ...], careless: str, skip: bool, held: int
) -> None:
    assert held_places(finish(open_changed, careless, *changes, skip=skip).database) == held
