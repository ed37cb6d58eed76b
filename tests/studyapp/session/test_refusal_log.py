from __future__ import annotations

import logging

import pytest
from sqlalchemy import create_engine, select

from studyapp.database.engine import Database
from studyapp.database.tables import RefusalLine
from studyapp.session import refusal
from studyapp.session.refusal import (
    ConflictError,
    RefusalError,
    StudyFullError,
    UnknownAddressError,
    log_refusal,
)
from tests.support.studies.taking_part_steps import Participant, SetClock


def note(participant: Participant, refusal: RefusalError, token: str | None = None) -> None:
    whose = participant.token if token is None else token
    log_refusal(participant.database, whose, "answers", refusal, participant.clock)


def noted(participant: Participant) -> list[tuple[int | None, str, str]]:
    with participant.database.reading() as session:
        lines = session.scalars(select(RefusalLine).order_by(RefusalLine.id))
        return [(line.study_session_id, line.kind, line.detail) for line in lines]


def test_a_study_that_is_full_refuses_nothing_wrong(participant: Participant) -> None:
    note(participant, StudyFullError("Full.", "Thank you."))

    assert noted(participant) == []


def test_an_address_that_belongs_to_nobody_is_not_noted_itself(participant: Participant) -> None:
    note(participant, UnknownAddressError("No.", "Try again."), token="s3cret")  # noqa: S106

    assert noted(participant) == [(None, "unknown-address", "answers: No.")]


def test_no_more_than_so_many_are_noted_of_one(
    participant: Participant, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(refusal, "MAX_LOGGED", 3)
    monkeypatch.setattr(refusal, "MAX_LOGGED_OF_UNKNOWN", 2)

    for _ in range(5):
        note(participant, ConflictError("No.", "Try again."))
        note(participant, UnknownAddressError("No.", "Try again."), token="nobody")  # noqa: S106

    kinds = [kind for _, kind, _ in noted(participant)]
    assert kinds.count("stale-page") == 3
    assert kinds.count("unknown-address") == 2


def test_a_refusal_that_cannot_be_noted_is_still_only_a_refusal(
    clock: SetClock, caplog: pytest.LogCaptureFixture
) -> None:
    without_tables = Database(create_engine("sqlite://", hide_parameters=True))

    with caplog.at_level(logging.ERROR):
        log_refusal(without_tables, "s3cret", "answers", ConflictError("No.", "Try."), clock)
    without_tables.close()

    assert "could not be noted" in caplog.text
    assert "s3cret" not in caplog.text
