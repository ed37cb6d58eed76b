"""The promises that the database itself keeps, whatever the code above it does."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import pytest
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from studyapp.database.engine import Database
from studyapp.database.tables import (
    Base,
    FormAnswer,
    Place,
    Response,
    StudySession,
    StudyVersion,
    Trial,
    TrialStimulus,
    Video,
    WatchRecord,
)

NOW = datetime(2026, 5, 4, tzinfo=UTC)


VERSION = {"number": 1, "design": "d", "definition": "", "operation": {}, "opened_at": NOW}


def study_session(token: str, **changes: Any) -> StudySession:
    values: dict[str, Any] = {
        "token": token,
        "version_id": 1,
        "arm": "a-b",
        "arm_design": "d",
        "conditions": ["a", "b"],
        "consented_at": NOW,
        "last_active_at": NOW,
    }
    return StudySession(**(values | changes))


def trial(**changes: Any) -> Trial:
    """Return a trial of one video that shows two stimuli."""
    video = Video(number=1, token=changes.pop("video_token", "video"), duration=2.0)
    values: dict[str, Any] = {
        "token": "trial",
        "position": 1,
        "kind": "main",
        "segment": "s",
        "emotion": "anger",
        "speaker": "robin",
        "videos": [video],
        "stimuli": [
            TrialStimulus(video=video, number=n, condition=name, segment="s", speech="s")
            for n, name in ((1, "a"), (2, "b"))
        ],
    }
    return Trial(**(values | changes))


def another() -> dict[str, str]:
    """Return tokens of another trial."""
    return {"token": "other trial", "video_token": "other video"}


def two_sessions_with_one_place() -> list[Base]:
    return [Place(arm="a-b", design="d", number=n, study_session_id=1) for n in range(2)]


def answers(*values: int, stimulus: int | None = None) -> list[Base]:
    """Return a trial and answers to it, which are stored after it."""
    given: dict[str, Any] = {
        "question": "q",
        "stimulus": stimulus,
        "reasons": [],
        "answered_at": NOW,
    }
    return [
        study_session("two", trials=[trial(id=7)]),
        *(Response(trial_id=7, value=value, **given) for value in values),
    ]


def store(session: Session, rows: list[Base]) -> None:
    for row in rows:
        session.add(row)
        session.flush()


def watch_record(video_id: int) -> WatchRecord:
    return WatchRecord(
        video_id=video_id,
        intervals=[],
        played_seconds=0.0,
        rate=1.0,
        hidden_seconds=0.0,
        silent_seconds=0.0,
        stalls=0,
        stalled_seconds=0.0,
        latest=[],
        reported_at=NOW,
    )


def watch_records(count: int) -> list[Base]:
    played = trial()
    played.videos[0].id = 7
    return [study_session("two", trials=[played]), *(watch_record(7) for _ in range(count))]


@pytest.mark.parametrize(
    "rows",
    [
        pytest.param(two_sessions_with_one_place, id="a session with two places"),
        pytest.param(
            lambda: [Place(arm="a-b", design="d", number=5) for _ in "ab"],
            id="a place twice",
        ),
        pytest.param(lambda: [study_session("one")], id="a token twice"),
        pytest.param(
            lambda: [study_session(t, recruiter_participant="p") for t in "ab"],
            id="a recruiter's participant twice",
        ),
        pytest.param(
            lambda: [study_session("a", completion_code="CODE")], id="a code before the end"
        ),
        pytest.param(lambda: answers(1, 1), id="an answer twice"),
        pytest.param(lambda: answers(1, 2, stimulus=1), id="an answer about a stimulus twice"),
        pytest.param(lambda: answers(1, stimulus=3), id="an answer about a stimulus not shown"),
        pytest.param(lambda: answers(101), id="a value out of range"),
        pytest.param(
            lambda: [study_session("a", trials=[trial(), trial(**another())])],
            id="two trials at one position",
        ),
        pytest.param(
            lambda: [study_session("a", trials=[trial(expected=1)])],
            id="an expected answer of a trial that is no catch trial",
        ),
        pytest.param(
            lambda: [study_session("a", trials=[trial(answered_at=NOW, unplayable_at=NOW)])],
            id="answered and unplayable",
        ),
        pytest.param(
            lambda: [study_session("a", trials=[trial(instructed=1)])],
            id="an instructed answer of a trial that is no attention check",
        ),
        pytest.param(lambda: watch_records(2), id="two watch records of a video"),
        pytest.param(
            lambda: [
                study_session(
                    "a",
                    form_answers=[
                        FormAnswer(stage="closing", question="q", value=value, answered_at=NOW)
                        for value in "ab"
                    ],
                )
            ],
            id="an answer of a form twice",
        ),
    ],
)
def test_the_database_refuses(database: Database, rows: Callable[[], list[Base]]) -> None:
    with database.writing() as session:
        session.add_all([StudyVersion(**VERSION), study_session("one")])

    with pytest.raises(IntegrityError), database.writing() as session:
        store(session, rows())
