"""Who is paid: the payment rule, beside what the recruiter knows."""

import pytest

from studyapp.database.engine import Database
from studyapp.recruitment.payment import (
    KnownParticipant,
    StudyStatus,
    Verdict,
    by_submission,
    judge_submission,
    known_participants,
)
from studyapp.session.enrolment import Arrival
from studyapp.session.form_answers import note_screen_out
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.recruitment import Prolific
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import Participant, SetClock

CODES = Prolific(completed="KX7QM2PWTR", screened_out="HB4NVJ9ZCD", failed_attention="WU3FGRE8KA")
WAITING = "AWAITING REVIEW"


@pytest.mark.parametrize(
    ("status", "code", "study_status", "verdict", "why"),
    [
        (WAITING, "NOCODE", "unwatched", "look", "too many videos"),
        (WAITING, "NOCODE", "completed", "pay", "finished, and entered no code"),
        (WAITING, "WU3FGRE8KA", "completed", "pay", "finished, and entered another code"),
        (WAITING, "WU3FGRE8KA", "failed_attention", "look", "failed too many attention checks"),
        (WAITING, "KX7QM2PWTR", "unfinished", "look", "not finish here, but entered the code"),
        (WAITING, "KX7QM2PWTR", "nobody", "look", "never began here, but entered the code"),
        (WAITING, "KX7QM2PWTR", "withdrawn", "look", "withdrew, but entered the code"),
        (WAITING, "KX7QM2PWTR", "screened_out", "look", "screened out, but entered the code"),
        (WAITING, "KX7QM2PWTR", "elsewhere", "look", "took part under another submission"),
        ("AWAITING_REVIEW", "KX7QM2PWTR", "completed", "pay", "finished"),
        ("TIMED-OUT", None, "completed", "look", "after Prolific's time was over"),
        ("TIMED-OUT", None, "unfinished", "settled", "timed-out"),
        ("ACTIVE", None, "unfinished", "wait", "is under way"),
        ("ACTIVE", None, "completed", "wait", "has not told Prolific yet"),
        ("APPROVED", "KX7QM2PWTR", "completed", "settled", "approved"),
    ],
)
def test_only_finished_unpaid_participants_are_paid(
    status: str, code: str | None, study_status: StudyStatus, verdict: Verdict, why: str
) -> None:
    judged = judge_submission(status, code, study_status, CODES)

    assert judged.verdict == verdict
    assert why in judged.reason


def test_a_participant_without_a_submission_id_is_matched_to_the_only_one() -> None:
    person = [KnownParticipant(participant="ann", session="", study_status="completed")]

    def states(*submissions: str) -> list[StudyStatus]:
        # In capitals or not, it is the same person.
        found = by_submission(person, [(each, "Ann") for each in submissions])
        return [each.study_status for each in found.values()]

    assert states("one") == ["completed"]
    assert states("one", "two") == ["elsewhere", "elsewhere"]


@BOTH
def test_everybody_sent_by_name_is_listed_with_their_status(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    def come(name: str) -> Participant:
        arrival = Arrival(
            recruiter_participant=name, recruiter_study="s", recruiter_session=f"{name}-submission"
        )
        return Participant(opened, served, clock).arrive(arrival)

    finished, _under_way, left = come("finished"), come("under way"), come("left")
    finished.begin().take_all()
    left.withdraw()
    for name in ("turned away", "finished"):
        arrival = Arrival(recruiter_participant=name)
        note_screen_out(opened, arrival.name, "eligibility", clock)
    finished.another().enrol("of-nobody")

    names = ("finished", "under way", "left", "turned away", "never came")
    known = by_submission(
        known_participants(opened),
        [*((f"{name}-submission", name) for name in names), ("again", "finished")],
    )

    assert {submission: each.study_status for submission, each in known.items()} == {
        "finished-submission": "completed",
        "under way-submission": "unfinished",
        "left-submission": "withdrawn",
        "turned away-submission": "screened_out",
        "never came-submission": "nobody",
        "again": "elsewhere",
    }
    assert known["finished-submission"].code
    assert known["left-submission"].session == ""
