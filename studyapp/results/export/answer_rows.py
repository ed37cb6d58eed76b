"""Export: what participants answered, as tables that hold no token and no name."""

from __future__ import annotations

from typing import Final

import pandas as pd
from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables import FormAnswer, StudySession, Trial, TrialStimulus, Video
from studyapp.session.state import state_of
from studyapp.session.videos.watch_evidence import watched_share

PAIR_COLUMNS: Final = (
    "comparison",
    "reference",
    "other",
    "left_condition",
    "right_condition",
    "left_speech",
    "right_speech",
)

EXPORT_COLUMNS: Final = (
    *("study_session", "comparison", "reference", "other", "segment", "emotion", "speaker"),
    *("kind", "position", "question", "left_condition", "right_condition", "value"),
    *("expected", "seconds", "watched", "answered_at", "instructed"),
    "version",
    "arm",
    "part",
    "stimulus",
    "condition",
    "speech",
    "left_speech",
    "right_speech",
    "reasons",
    "shown_at",
)
"""What all protocols have to say; where one has nothing to say, its columns are empty."""

STUDY_SESSION_COLUMNS: Final = (
    "study_session",
    "version",
    "arm",
    "state",
    "consented_at",
    "started_at",
    "completed_at",
    "presentations",
    "answered",
    "unplayable",
)

FORM_COLUMNS: Final = ("study_session", "stage", "question", "value")


def responses_table(session: Session, *, withdrawn: bool = False) -> pd.DataFrame:
    """Return every stored answer, one row per answered question and stimulus.

    Answers of all kinds of trial and of unfinished study sessions are included; those of
    participants who withdrew are not. With `withdrawn`, only theirs are, as far as they were kept.

    Of a trial that shows two stimuli, `left_…` and `right_…` say what was A and B, and
    `comparison` names the pair: `reference` is the one the study puts first. Of a catch trial,
    `other` is the visibly flawed condition and `reference` the one it is shown beside. These
    columns are empty for other trials. An answer about one stimulus names it in `stimulus` (its
    number), `condition` and `speech`, which are empty for answers about the whole trial. The
    `reasons` ticked for an order stand beside each of its ranks.

    Returns
    -------
    DataFrame
        Columns `EXPORT_COLUMNS`, ordered by study session, position and answer.
    """
    rows = []
    for study_session in session.scalars(
        select(StudySession)
        .where(_chosen(withdrawn))
        .order_by(StudySession.id)
        .options(
            selectinload(StudySession.version),
            selectinload(StudySession.trials).selectinload(Trial.responses),
            selectinload(StudySession.trials).selectinload(Trial.stimuli),
            selectinload(StudySession.trials)
            .selectinload(Trial.videos)
            .selectinload(Video.watch_record),
        )
    ):
        for trial in study_session.trials:
            rows.extend(_rows(study_session, trial))
    return pd.DataFrame(rows, columns=list(EXPORT_COLUMNS))


def _rows(study_session: StudySession, trial: Trial) -> list[dict[str, object]]:
    """Return one row for each answer of `trial`."""
    of_the_trial = {
        "study_session": str(study_session.id),
        "version": study_session.version.number,
        "arm": study_session.arm,
        "segment": trial.segment,
        "emotion": trial.emotion,
        "speaker": trial.speaker,
        "kind": trial.kind,
        "part": trial.part,
        "position": trial.position,
        "expected": "" if trial.expected is None else str(trial.expected),
        "instructed": "" if trial.instructed is None else str(trial.instructed),
        "shown_at": trial.shown_at.isoformat() if trial.shown_at else "",
        "seconds": trial.seconds,
        "watched": round(watched_share(trial.videos), 4),
        **_pair(study_session, trial),
    }
    stimuli = {shown.number: shown for shown in trial.stimuli}
    return [
        {
            **of_the_trial,
            "question": response.question,
            "value": response.value,
            "reasons": " ".join(response.reasons),
            "answered_at": response.answered_at.isoformat(),
            **_about(stimuli.get(response.stimulus or 0) if response.stimulus else None),
        }
        for response in sorted(trial.responses, key=lambda response: response.id)
    ]


def _about(shown: TrialStimulus | None) -> dict[str, object]:
    """Return what an answer is about; empty columns where it is about the whole trial."""
    if shown is None:
        return {"stimulus": "", "condition": "", "speech": ""}
    return {
        "stimulus": str(shown.number),
        "condition": shown.condition,
        "speech": shown.speech or "",
    }


def _pair(study_session: StudySession, trial: Trial) -> dict[str, object]:
    """Return the columns about a pair; empty ones where a trial shows none."""
    judged = [shown for shown in trial.stimuli if shown.number > 0]
    if len(judged) != 2:
        return dict.fromkeys(PAIR_COLUMNS, "")
    left, right = judged
    order = study_session.conditions
    shown = [left.condition, right.condition]
    if trial.expected is not None:
        reference = shown[trial.expected - 1]
        other = shown[2 - trial.expected]
    else:
        reference, other = sorted(shown, key=order.index)
    one_pair = len(order) == 2
    return {
        "comparison": study_session.arm if one_pair else f"{reference}-{other}",
        "reference": reference,
        "other": other,
        "left_condition": left.condition,
        "right_condition": right.condition,
        "left_speech": left.speech or "",
        "right_speech": right.speech or "",
        "expected": "" if trial.expected is None else ("left", "right")[trial.expected - 1],
    }


def study_sessions_table(session: Session) -> pd.DataFrame:
    """Return every study session and where it stands, for the participant flow.

    Returns
    -------
    DataFrame
        Columns `STUDY_SESSION_COLUMNS`; `state` is ``instructed``, ``started``, ``completed``,
        ``unwatched``, ``withdrawn`` or ``lapsed`` (silent for so long that the place was given
        back); moments are ISO 8601 in UTC, empty where there is none.
    """
    rows = [
        (
            str(study_session.id),
            study_session.version.number,
            study_session.arm,
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
                selectinload(StudySession.version),
            )
        )
    ]
    return pd.DataFrame(rows, columns=list(STUDY_SESSION_COLUMNS))


def _chosen(withdrawn: bool) -> ColumnElement[bool]:
    if withdrawn:
        return StudySession.withdrawn_at.is_not(None)
    return StudySession.withdrawn_at.is_(None)


def form_answers_table(session: Session, *, withdrawn: bool = False) -> pd.DataFrame:
    """Return what participants said about themselves, one row per answered question.

    Returns
    -------
    DataFrame
        Columns `FORM_COLUMNS`; who withdrew is left out. With `withdrawn`, nobody else is in it.
    """
    rows = [
        (str(answer.study_session_id), answer.stage, answer.question, answer.value)
        for answer in session.scalars(
            select(FormAnswer)
            .join(FormAnswer.study_session)
            .where(_chosen(withdrawn))
            .order_by(FormAnswer.study_session_id, FormAnswer.id)
        )
    ]
    return pd.DataFrame(rows, columns=list(FORM_COLUMNS))
