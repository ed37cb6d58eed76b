"""Everything that was answered, in columns: fast to read however many answers there are."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from operator import itemgetter
from typing import Any, Final, Literal, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sqlalchemy import ColumnElement, Select, case, exists, func, select
from sqlalchemy.orm import Session

from studyapp.database.tables import (
    Look,
    Place,
    Response,
    StudySession,
    StudyVersion,
    Trial,
    TrialStimulus,
    Video,
    WatchRecord,
)
from studyapp.researchers.audit import COMMAND_LINE
from studyapp.researchers.exclusion_decisions import current_exclusions
from studyapp.session.ending import JUDGED
from studyapp.session.intake import current_intake
from studyapp.session.screening import count_screened_out
from studyapp.session.state import state_of
from studyapp.session.watch_evidence import watched_share
from studyapp.study.settings.study import Study

ROWS: Final = 20_000
"""Rows that are fetched at once."""

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
    """What a study's database knows of answers; who withdrew is among the study sessions alone.

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
        `planned` and `answers` (see `studyapp.database.tables.Look`).
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

    def part(self, study_sessions: NDArray[np.bool_]) -> StoredAnswers:
        """Return what belongs to some of the study sessions."""
        chosen = self.study_sessions[study_sessions]
        trials = self.trials[self.trials["study_session"].isin(chosen["study_session"])]
        return StoredAnswers(
            study_sessions=chosen,
            trials=trials,
            answers=self.answers[self.answers["trial"].isin(trials["trial"])],
            stimuli=self.stimuli[self.stimuli["trial"].isin(trials["trial"])],
            looks=self.looks,
            more_places=self.more_places,
            screened_out=self.screened_out,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Answers:
    """What has been answered, and by whom.

    Attributes
    ----------
    origin : {'participants', 'rehearsal', 'none'}
        Who answered; 'none' where nobody has.
    stored : StoredAnswers or None
        What the database holds; None where there is none.
    stated : Study or None
        The study as it was when the first participant came who is reported; None where that is
        not known.
    """

    origin: Source | Literal["none"]
    stored: StoredAnswers | None
    stated: Study | None


NO_ANSWERS: Final = Answers(origin="none", stored=None, stated=None)


def stored_answers(
    session: Session, *, withdrawn: bool = False, in_full: bool = False
) -> StoredAnswers:
    """Read what was answered, whole study sessions or not, from one state of the database.

    Parameters
    ----------
    withdrawn : bool
        Whether trials and answers are those that were kept of who withdrew, and no others.
    in_full : bool
        Whether columns are there which exports alone have. Some of them lead to people, so that
        no other lab is given them.
    """
    with _garbage_left():
        return _read(session, withdrawn, in_full)


@contextmanager
def _garbage_left() -> Iterator[None]:
    """Keep the garbage collector from looking at all rows again and again; none holds itself."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def _read(session: Session, withdrawn: bool, in_full: bool) -> StoredAnswers:
    whose = whose_answers(withdrawn)
    return StoredAnswers(
        study_sessions=_study_sessions(session, in_full),
        trials=_trials(session, whose, in_full).merge(
            _watched(session, whose), on="trial", how="left"
        ),
        answers=_frame(
            session,
            select(
                Response.trial_id.label("trial"),
                Response.question,
                func.coalesce(Response.stimulus, 0).label("stimulus"),
                Response.value,
                *((Response.reasons, Response.answered_at) if in_full else ()),
            )
            .join(Trial, Trial.id == Response.trial_id)
            .join(StudySession, StudySession.id == Trial.study_session_id)
            .where(whose)
            .order_by(StudySession.id, Trial.position, Response.id),
        ),
        stimuli=_frame(
            session,
            _of_answered(
                select(
                    TrialStimulus.trial_id.label("trial"),
                    TrialStimulus.number,
                    TrialStimulus.condition,
                    TrialStimulus.segment,
                    func.coalesce(TrialStimulus.speech, "").label("speech"),
                )
                .join(Trial, Trial.id == TrialStimulus.trial_id)
                .where(TrialStimulus.number > 0),
                whose,
            ).order_by(TrialStimulus.trial_id, TrialStimulus.number),
        ),
        looks=_looks(session),
        more_places=current_intake(session).more_places,
        screened_out=count_screened_out(session),
    )


def whose_answers(withdrawn: bool) -> ColumnElement[bool]:
    """Choose the study sessions of who withdrew, or all others."""
    gone = StudySession.withdrawn_at
    return gone.is_not(None) if withdrawn else gone.is_(None)


def _looks(session: Session) -> pd.DataFrame:
    """Return the log of looks; who looked is told apart, not named."""
    rows = list(session.scalars(select(Look).order_by(Look.id)))
    names = dict.fromkeys(row.researcher for row in rows if row.researcher)
    called = {name: f"researcher {number}" for number, name in enumerate(names, start=1)}
    found = pd.DataFrame(
        [
            (
                row.at.date().isoformat(),
                called.get(row.researcher, COMMAND_LINE),
                row.way,
                row.reason,
                row.finished,
                row.planned,
                row.answers,
            )
            for row in rows
        ],
        columns=["day", "by", "way", "reason", "finished", "planned", "answers"],
    )
    return found.astype(dict.fromkeys(("finished", "planned", "answers"), "int64"))


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
    found = pd.DataFrame(rows, columns=[column.key for column in query.selected_columns])
    if in_full:
        found["state"] = [state_of(row) for row in rows]
    truths = ("withdrawn", "completed", "unwatched", "placed", "excluded_after_look")
    return found.astype(dict.fromkeys(truths, bool))


def _trials(session: Session, whose: ColumnElement[bool], in_full: bool) -> pd.DataFrame:
    found = _frame(
        session,
        _of_answered(
            select(
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
            ),
            whose,
        ).order_by(Trial.study_session_id, Trial.position),
    )
    return found.astype(dict.fromkeys(("expected", "instructed", "seconds"), "float64"))


def _of_answered(
    query: Select[*tuple[object, ...]], whose: ColumnElement[bool]
) -> Select[*tuple[object, ...]]:
    """Keep what belongs to answered trials."""
    return query.join(StudySession, StudySession.id == Trial.study_session_id).where(
        whose, Trial.answered_at.is_not(None)
    )


def _frame(session: Session, query: Select[*tuple[object, ...]]) -> pd.DataFrame:
    names = [column.key for column in query.selected_columns]
    blocks = []
    result = session.execute(query)
    while rows := result.fetchmany(ROWS):
        blocks.append(pd.DataFrame(rows, columns=names))
    return pd.concat(blocks, ignore_index=True) if blocks else pd.DataFrame(columns=names)


class _Record(NamedTuple):
    """As much of a watch record as must be known to judge it."""

    intervals: list[list[float]]
    latest: list[list[int]]


class _Video(NamedTuple):
    """A video of a trial, with what was reported of it."""

    duration: float
    sent_at: datetime | None
    watch_record: _Record | None


def _watched(session: Session, whose: ColumnElement[bool]) -> pd.DataFrame:
    """Return which share of the videos of each answered trial was watched."""
    rows = list(_shares(session, whose))
    found = pd.DataFrame(rows, columns=["trial", "watched"])
    return found.astype({"trial": "int64", "watched": "float64"})


def _shares(session: Session, whose: ColumnElement[bool]) -> Iterator[tuple[int, float]]:
    query = _of_answered(
        select(Trial.id, Video.duration, Video.sent_at, WatchRecord.intervals)
        .join(Video, Video.trial_id == Trial.id)
        .outerjoin(WatchRecord, WatchRecord.video_id == Video.id),
        whose,
    ).order_by(Trial.id)
    found = session.execute(query.execution_options(yield_per=ROWS)).partitions()
    rows: Iterator[tuple[Any, ...]] = (tuple(row) for block in found for row in block)
    for trial, of_trial in groupby(rows, key=itemgetter(0)):
        yield trial, round(watched_share([_video(*row[1:]) for row in of_trial]), 4)


def _video(
    duration: float, sent_at: datetime | None, intervals: list[list[float]] | None
) -> _Video:
    record = None if intervals is None else _Record(intervals=intervals, latest=[])
    return _Video(duration=duration, sent_at=sent_at, watch_record=record)
