"""Export: what participants answered, as tables that hold no token and no name."""

from __future__ import annotations

from typing import Final

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import selectinload

from analysis.responses import COLUMNS
from studyapp.models import StudySession, Trial
from studyapp.services.database import Database
from studyapp.services.sitting import state_of
from studyapp.services.watching import watched_share

STUDY_SESSION_COLUMNS: Final = (
    "study_session",
    "comparison",
    "state",
    "consented_at",
    "started_at",
    "completed_at",
    "presentations",
    "answered",
    "unplayable",
)


def responses_table(database: Database) -> pd.DataFrame:
    """Return every stored answer, one row per answered question.

    Answers of all kinds of trial and of unfinished study sessions are included; those of
    participants who withdrew are not. Of a catch trial, `other` is the visibly flawed condition
    and `reference` the one it is shown beside.

    Returns
    -------
    DataFrame
        Columns `analysis.responses.COLUMNS`, ordered by study session, position and question.
    """
    rows = []
    with database.reading() as session:
        for study_session in session.scalars(
            select(StudySession)
            .where(StudySession.withdrawn_at.is_(None))
            .order_by(StudySession.id)
            .options(
                selectinload(StudySession.trials).selectinload(Trial.responses),
                selectinload(StudySession.trials).selectinload(Trial.watch_batches),
            )
        ):
            for trial in study_session.trials:
                rows.extend(_rows(study_session, trial))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _rows(study_session: StudySession, trial: Trial) -> list[tuple[object, ...]]:
    reference, other = study_session.reference, study_session.other
    if trial.kind == "catch":
        reference, other = trial.left_condition, trial.right_condition
        if trial.expected == "right":
            reference, other = other, reference
    return [
        (
            str(study_session.id),
            study_session.comparison,
            reference,
            other,
            trial.segment,
            trial.emotion,
            trial.speaker,
            trial.kind,
            trial.position,
            response.question,
            trial.left_condition,
            trial.right_condition,
            response.value,
            trial.expected,
            trial.seconds,
            round(watched_share(trial), 4),
            response.answered_at.isoformat(),
        )
        for response in sorted(trial.responses, key=lambda response: response.id)
    ]


def study_sessions_table(database: Database) -> pd.DataFrame:
    """Return every study session and where it stands, for the participant flow.

    Returns
    -------
    DataFrame
        Columns `STUDY_SESSION_COLUMNS`; `state` is ``instructed``, ``started``, ``completed``,
        ``withdrawn`` or ``lapsed`` (silent for so long that the place was given back); moments
        are ISO 8601 in UTC, empty where there is none.
    """
    with database.reading() as session:
        rows = [
            (
                str(study_session.id),
                study_session.comparison,
                state_of(study_session),
                study_session.consented_at.isoformat(),
                study_session.started_at.isoformat() if study_session.started_at else "",
                study_session.completed_at.isoformat() if study_session.completed_at else "",
                len(study_session.trials),
                sum(trial.answered_at is not None for trial in study_session.trials),
                sum(trial.unplayable_at is not None for trial in study_session.trials),
            )
            for study_session in session.scalars(
                select(StudySession)
                .order_by(StudySession.id)
                .options(
                    selectinload(StudySession.trials),
                    selectinload(StudySession.place),
                )
            )
        ]
    return pd.DataFrame(rows, columns=list(STUDY_SESSION_COLUMNS))
