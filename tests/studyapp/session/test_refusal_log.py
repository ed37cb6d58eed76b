import logging

import pytest
from sqlalchemy import create_engine, select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import RefusalLine
from studyapp.session import refusal
from studyapp.session.refusal import ConflictError, StudyFullError, UnknownAddressError, log_refusal
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant, SetClock


def test_refusals_are_logged_up_to_a_limit_and_never_for_a_full_study(
    participant: Participant, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(refusal, "MAX_LOGGED", 3)

    for kind in (StudyFullError, ConflictError, UnknownAddressError):
        token = "nobody" if kind is UnknownAddressError else participant.token
        for _ in range(5):
            error = kind("No.", "Try again.")
            log_refusal(participant.database, token, "answers", error, participant.clock)

    lines = found_in(participant.database, select(RefusalLine).order_by(RefusalLine.id))
    logged = [(line.study_session_id, line.kind) for line in lines]
    assert logged == [(1, "stale-page")] * 3 + [(None, "unknown-address")] * 3


def test_a_refusal_that_cannot_be_logged_is_still_a_refusal(
    clock: SetClock, caplog: pytest.LogCaptureFixture
) -> None:
    without_tables = Database(create_engine("sqlite://", hide_parameters=True))

    with caplog.at_level(logging.ERROR):
        log_refusal(without_tables, "s3cret", "answers", ConflictError("No.", "Try."), clock)
    without_tables.close()

    assert "could not be noted" in caplog.text
    assert "s3cret" not in caplog.text
