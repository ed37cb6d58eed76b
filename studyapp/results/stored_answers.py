"""All stored answers as data frames, which are fast to read however many there are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import itemgetter
from typing import Any, Final, Literal

import pandas as pd
from sqlalchemy import ColumnElement, Select, case, exists, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from motion.arrays import Bools
from studyapp.database.tables.researchers import Look
from studyapp.database.tables.study_session import Place, StudySession, StudyVersion
from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord
from studyapp.researchers.audit import COMMAND_LINE
from studyapp.researchers.exclusion_decisions import current_exclusions
from studyapp.session.ending import JUDGED
from studyapp.session.form_answers import count_screened_out
from studyapp.session.intake import current_intake
from studyapp.session.state import state_of
from studyapp.session.watch_evidence import watched_share
from studyapp.study.settings.study import Study

BATCH_ROWS: Final = 20_000
"""Rows fetched at once."""

_IN_FULL: Final = (
    StudySession.conditions,
    StudySession.consented_at,
    StudySession.started_at,
    StudySession.completed_at,
    StudySession.withdrawn_at,
    StudySession.outcome,
    Place.id.label("place"),
)


Source = Literal["participants", "rehearsal"]


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredAnswers:
    """The answers in a study's database; participants who withdrew have only a study session.

    Attributes
    ----------
    study_sessions : DataFrame
        One row for each: `study_session`, `version`, `arm`, `arm_design`, `withdrawn`,
        `completed` (bool), `trials` and `settled`, how many of them are done with, `placed`
        (bool), `excluded_because`, a researcher's reason (empty where nobody excluded them), and
        `excluded_after_look`, whether results had been looked at before that (bool). In full also
        `state` (see `studyapp.session.state.state_of`), `conditions`, `consented_at`,
        `started_at`, `completed_at` and `unplayable`, how many trials were left out.
    trials : DataFrame
        One row for each trial that has an answer: `trial`, `study_session`, `position`, `kind`,
        `part`, `segment`, `emotion`, `speaker`, `expected`, `instructed` (NaN for none),
        `seconds`, `watched` (in [0, 1]); in full also `shown_at`.
    answers : DataFrame
        One row for each answer: `trial`, `question`, `stimulus` (0 for the whole trial), `value`;
        in full also `reasons` and `answered_at`.
    stimuli : DataFrame
        One row for each stimulus judged in `trials`: `trial`, `number`, `condition`, `segment`,
        `speech` (empty for silence).
    looks : DataFrame
        One row for each time that results were seen, the first one first: `day` (UTC), `by`
        (``researcher 1``, ``researcher 2`` … or ``command line``), `way`, `reason`, `finished`,
        `planned` and `answers` (see `studyapp.database.tables.researchers.Look`).
    more_places : int
        Places of each arm that researchers wanted beyond those of the study file.
    screened_out : mapping of str to int
        How many were screened out at each stage, before they had a place or the trials began.
    """

    study_sessions: pd.DataFrame
    trials: pd.DataFrame
    answers: pd.DataFrame
    stimuli: pd.DataFrame
    looks: pd.DataFrame
    more_places: int
    screened_out: Mapping[str, int]

    def part(self, study_sessions: Bools) -> StoredAnswers:
        """Return the answers of some study sessions."""
        chosen = self.study_sessions[study_sessions]
        trials = self.trials[self.trials["study_session"].isin(chosen["study_session"])]
        return replace(
            self,
            study_sessions=chosen,
            trials=trials,
            answers=self.answers[self.answers["trial"].isin(trials["trial"])],
            stimuli=self.stimuli[self.stimuli["trial"].isin(trials["trial"])],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Answers:
    """The answers of a study, and their origin.

    Attributes
    ----------
    origin : {'participants', 'rehearsal', 'none'}
        Who answered; 'none' without answers.
    stored : StoredAnswers or None
        The answers in the database; None without a database.
    stated : Study or None
        The study as the first reported participant saw it, if known.
    """

    origin: Source | Literal["none"]
    stored: StoredAnswers | None
    stated: Study | None


NO_ANSWERS: Final = Answers(origin="none", stored=None, stated=None)


def stored_answers(
    session: Session, *, withdrawn: bool = False, in_full: bool = False
) -> StoredAnswers:
    """Read all answers, also of unfinished study sessions, from one state of the database.

    Parameters
    ----------
    withdrawn : bool
        Read the remaining data of participants who withdrew instead.
    in_full : bool
        Add the columns that only exports have. Some of them can identify people, so other labs
        do not get them.
    """
    chosen = select_sessions(withdrawn)
    answers = select(
        Response.trial_id.label("trial"),
        Response.question,
        func.coalesce(Response.stimulus, 0).label("stimulus"),
        Response.value,
        *((Response.reasons, Response.answered_at) if in_full else ()),
    ).join(Trial, Trial.id == Response.trial_id)
    stimuli = (
        select(
            TrialStimulus.trial_id.label("trial"),
            TrialStimulus.number,
            TrialStimulus.condition,
            TrialStimulus.segment,
            func.coalesce(TrialStimulus.speech, "").label("speech"),
        )
        .join(Trial, Trial.id == TrialStimulus.trial_id)
        .where(TrialStimulus.number > 0)
    )
    trials = select(
        Trial.id.label("trial"),
        Trial.study_session_id.label("study_session"),
        Trial.position,
        Trial.kind,
        Trial.part,
        Trial.segment,
        Trial.emotion,
        Trial.speaker,
        Trial.expected,
        Trial.instructed,
        Trial.seconds,
        *((Trial.shown_at,) if in_full else ()),
    )
    place = (Trial.study_session_id, Trial.position)
    numbers = dict.fromkeys(("expected", "instructed", "seconds"), "float64")
    return StoredAnswers(
        study_sessions=_study_sessions(session, in_full),
        trials=_frame(session, trials, chosen, *place)
        .astype(numbers)
        .merge(_watched(session, chosen), on="trial", how="left"),
        answers=_frame(session, answers, chosen, *place, Response.id),
        stimuli=_frame(session, stimuli, chosen, TrialStimulus.trial_id, TrialStimulus.number),
        looks=_looks(session),
        more_places=current_intake(session).more_places,
        screened_out=count_screened_out(session),
    )


def select_sessions(withdrawn: bool) -> ColumnElement[bool]:
    """Return the condition for study sessions that were withdrawn, or all others."""
    withdrawn_at = StudySession.withdrawn_at
    return withdrawn_at.is_not(None) if withdrawn else withdrawn_at.is_(None)


def _looks(session: Session) -> pd.DataFrame:
    """Return the log of looks, with numbers instead of researchers' names."""
    rows = list(session.scalars(select(Look).order_by(Look.id)))
    names = dict.fromkeys(row.researcher for row in rows if row.researcher)
    labels = {name: f"researcher {number}" for number, name in enumerate(names, start=1)}
    lines = [
        (
            row.at.date().isoformat(),
            labels.get(row.researcher, COMMAND_LINE),
            row.way,
            row.reason,
            row.finished,
            row.planned,
            row.answers,
        )
        for row in rows
    ]
    texts, numbers = ("day", "by", "way", "reason"), ("finished", "planned", "answers")
    types = dict.fromkeys(texts, "str") | dict.fromkeys(numbers, "int64")
    return pd.DataFrame(lines, columns=list(types)).astype(types)


def _study_sessions(session: Session, in_full: bool) -> pd.DataFrame:
    planned = (
        select(
            Trial.study_session_id.label("owner"),
            func.count().label("trials"),
            (func.count(Trial.answered_at) + func.count(Trial.unplayable_at)).label("settled"),
            func.count(Trial.unplayable_at).label("unplayable"),
            *(
                func.count(case((Trial.kind == kind, Trial.unplayable_at))).label(
                    f"left_out_{kind}"
                )
                for kind in JUDGED
            ),
        )
        .group_by(Trial.study_session_id)
        .subquery()
    )
    excluded = current_exclusions().subquery()
    query = (
        select(
            StudySession.id.label("study_session"),
            StudyVersion.number.label("version"),
            StudySession.arm,
            StudySession.arm_design,
            StudySession.withdrawn_at.is_not(None).label("withdrawn"),
            StudySession.completed_at.is_not(None).label("completed"),
            func.coalesce(planned.c.trials, 0).label("trials"),
            func.coalesce(planned.c.settled, 0).label("settled"),
            func.coalesce(planned.c.left_out_catch, 0).label("left_out_catch"),
            func.coalesce(planned.c.left_out_attention, 0).label("left_out_attention"),
            func.coalesce(StudySession.outcome == "unwatched", False).label("unwatched"),
            Place.id.is_not(None).label("placed"),
            func.coalesce(excluded.c.reason, "").label("excluded_because"),
            exists().where(Look.at <= excluded.c.at).label("excluded_after_look"),
            *(_IN_FULL if in_full else ()),
            *((func.coalesce(planned.c.unplayable, 0).label("unplayable"),) if in_full else ()),
        )
        .join(StudyVersion, StudyVersion.id == StudySession.version_id)
        .outerjoin(planned, planned.c.owner == StudySession.id)
        .outerjoin(Place, Place.study_session_id == StudySession.id)
        .outerjoin(excluded, excluded.c.study_session_id == StudySession.id)
        .order_by(StudySession.id)
    )
    rows: Sequence[Any] = session.execute(query).all()
    frame = pd.DataFrame(rows, columns=[column.key for column in query.selected_columns])
    if in_full:
        frame["state"] = [state_of(row) for row in rows]
    booleans = ("withdrawn", "completed", "unwatched", "placed", "excluded_after_look")
    return frame.astype(dict.fromkeys(booleans, bool))


def _in_answered_trials(
    query: Select[*tuple[object, ...]], chosen: ColumnElement[bool]
) -> Select[*tuple[object, ...]]:
    """Restrict a query to answered trials."""
    return query.join(StudySession, StudySession.id == Trial.study_session_id).where(
        chosen, Trial.answered_at.is_not(None)
    )


def _frame(
    session: Session,
    query: Select[*tuple[object, ...]],
    chosen: ColumnElement[bool],
    *order: InstrumentedAttribute[Any],
) -> pd.DataFrame:
    names = [column.key for column in query.selected_columns]
    blocks = []
    result = session.execute(_in_answered_trials(query, chosen).order_by(*order))
    while rows := result.fetchmany(BATCH_ROWS):
        blocks.append(pd.DataFrame(rows, columns=names))
    return pd.concat(blocks, ignore_index=True) if blocks else pd.DataFrame(columns=names)


def _watched(session: Session, chosen: ColumnElement[bool]) -> pd.DataFrame:
    """Return the watched share of the videos of each answered trial."""
    query = _in_answered_trials(
        select(Trial.id, Video.duration, Video.sent_at, WatchRecord.intervals)
        .join(Video, Video.trial_id == Trial.id)
        .outerjoin(WatchRecord, WatchRecord.video_id == Video.id),
        chosen,
    ).order_by(Trial.id)
    blocks = session.execute(query.execution_options(yield_per=BATCH_ROWS)).partitions()
    rows: Iterator[tuple[Any, ...]] = (tuple(row) for block in blocks for row in block)
    shares = [
        (trial, round(watched_share(row[1:] for row in videos), 4))
        for trial, videos in groupby(rows, key=itemgetter(0))
    ]
    frame = pd.DataFrame(shares, columns=["trial", "watched"])
    return frame.astype({"trial": "int64", "watched": "float64"})
