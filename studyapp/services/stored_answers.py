"""Everything that was answered, in columns: fast to read however many answers there are."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Any, Final, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sqlalchemy import Select, exists, func, select

from studyapp.models import (
    Look,
    Place,
    Response,
    StudySession,
    StudyVersion,
    Trial,
    TrialStimulus,
    Video,
    WatchBatch,
)
from studyapp.services.database import Database
from studyapp.services.exclusion_decisions import standing_exclusions
from studyapp.services.intake import present_intake
from studyapp.services.looks import COMMAND_LINE
from studyapp.services.watch_evidence import length, watched_so_far

ROWS: Final = 20_000
"""Rows that are fetched at once."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredAnswers:
    """What a study's database knows of answers; who withdrew is among the study sessions alone.

    Attributes
    ----------
    study_sessions : DataFrame
        One row for each: `study_session`, `version`, `arm`, `arm_design`, `withdrawn`,
        `completed` (bool), `trials` and `settled`, how many of them are done with, `placed`
        (bool), `excluded_because`, a researcher's reason (empty where nobody excluded them), and
        `excluded_after_look`, whether results had been looked at before that (bool).
    trials : DataFrame
        One row for each trial that has an answer: `trial`, `study_session`, `position`, `kind`,
        `part`, `segment`, `emotion`, `speaker`, `expected`, `instructed` (NaN for none),
        `seconds`, `watched` (in [0, 1]).
    answers : DataFrame
        One row for each answer: `trial`, `question`, `stimulus` (0 for the whole trial), `value`.
    stimuli : DataFrame
        One row for each stimulus judged in `trials`: `trial`, `number`, `condition`, `segment`,
        `speech` (empty for silence).
    looks : DataFrame
        One row for each time that results were seen, the first one first: `day` (UTC), `by`
        (``researcher 1``, ``researcher 2`` … or ``command line``), `way`, `reason`, `finished`,
        `planned` and `answers` (see `studyapp.models.Look`).
    more_places : int
        Places of each arm that researchers wanted beyond those of the study file.
    """

    study_sessions: pd.DataFrame
    trials: pd.DataFrame
    answers: pd.DataFrame
    stimuli: pd.DataFrame
    looks: pd.DataFrame
    more_places: int

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
        )


def stored_answers(database: Database) -> StoredAnswers:
    """Read what was answered, whole study sessions or not."""
    with _garbage_left():
        return _read(database)


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


def _read(database: Database) -> StoredAnswers:
    return StoredAnswers(
        study_sessions=_study_sessions(database),
        trials=_trials(database).merge(_watched(database), on="trial", how="left"),
        answers=_frame(
            database,
            select(
                Response.trial_id.label("trial"),
                Response.question,
                func.coalesce(Response.stimulus, 0).label("stimulus"),
                Response.value,
            )
            .join(Trial, Trial.id == Response.trial_id)
            .join(StudySession, StudySession.id == Trial.study_session_id)
            .where(StudySession.withdrawn_at.is_(None))
            .order_by(StudySession.id, Trial.position, Response.id),
        ),
        stimuli=_frame(
            database,
            _of_answered(
                select(
                    TrialStimulus.trial_id.label("trial"),
                    TrialStimulus.number,
                    TrialStimulus.condition,
                    TrialStimulus.segment,
                    func.coalesce(TrialStimulus.speech, "").label("speech"),
                )
                .join(Trial, Trial.id == TrialStimulus.trial_id)
                .where(TrialStimulus.number > 0)
            ).order_by(TrialStimulus.trial_id, TrialStimulus.number),
        ),
        looks=_looks(database),
        more_places=_more_places(database),
    )


def _looks(database: Database) -> pd.DataFrame:
    """Return the log of looks; who looked is told apart, not named."""
    with database.reading() as session:
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


def _more_places(database: Database) -> int:
    with database.reading() as session:
        return present_intake(session).more_places


def _study_sessions(database: Database) -> pd.DataFrame:
    planned = (
        select(
            Trial.study_session_id.label("owner"),
            func.count().label("trials"),
            (func.count(Trial.answered_at) + func.count(Trial.unplayable_at)).label("settled"),
        )
        .group_by(Trial.study_session_id)
        .subquery()
    )
    excluded = standing_exclusions().subquery()
    found = _frame(
        database,
        select(
            StudySession.id.label("study_session"),
            StudyVersion.number.label("version"),
            StudySession.arm,
            StudySession.arm_design,
            StudySession.withdrawn_at.is_not(None).label("withdrawn"),
            StudySession.completed_at.is_not(None).label("completed"),
            func.coalesce(planned.c.trials, 0).label("trials"),
            func.coalesce(planned.c.settled, 0).label("settled"),
            Place.id.is_not(None).label("placed"),
            func.coalesce(excluded.c.reason, "").label("excluded_because"),
            exists().where(Look.at <= excluded.c.at).label("excluded_after_look"),
        )
        .join(StudyVersion, StudyVersion.id == StudySession.version_id)
        .outerjoin(planned, planned.c.owner == StudySession.id)
        .outerjoin(Place, Place.study_session_id == StudySession.id)
        .outerjoin(excluded, excluded.c.study_session_id == StudySession.id)
        .order_by(StudySession.id),
    )
    truths = ("withdrawn", "completed", "placed", "excluded_after_look")
    return found.astype(dict.fromkeys(truths, bool))


def _trials(database: Database) -> pd.DataFrame:
    found = _frame(
        database,
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
            )
        ).order_by(Trial.study_session_id, Trial.position),
    )
    return found.astype(dict.fromkeys(("expected", "instructed", "seconds"), "float64"))


def _of_answered(query: Select[*tuple[object, ...]]) -> Select[*tuple[object, ...]]:
    """Keep what belongs to answered trials of those who did not withdraw."""
    return query.join(StudySession, StudySession.id == Trial.study_session_id).where(
        StudySession.withdrawn_at.is_(None), Trial.answered_at.is_not(None)
    )


def _frame(database: Database, query: Select[*tuple[object, ...]]) -> pd.DataFrame:
    names = [column.key for column in query.selected_columns]
    blocks = []
    with database.reading() as session:
        result = session.execute(query)
        while rows := result.fetchmany(ROWS):
            blocks.append(pd.DataFrame(rows, columns=names))
    return pd.concat(blocks, ignore_index=True) if blocks else pd.DataFrame(columns=names)


class _Report(NamedTuple):
    """A report of playing, with as much as must be known to judge it."""

    batch: int
    intervals: list[list[float]]
    rate: float
    hidden_seconds: float
    silent_seconds: float


class _Video(NamedTuple):
    """A video of a trial, with the reports of it."""

    duration: float
    soundless: bool
    watch_batches: tuple[_Report, ...]


def _watched(database: Database) -> pd.DataFrame:
    """Return which share of the videos of each answered trial was watched."""
    rows = list(_shares(database))
    found = pd.DataFrame(rows, columns=["trial", "watched"])
    return found.astype({"trial": "int64", "watched": "float64"})


def _shares(database: Database) -> Iterator[tuple[int, float]]:
    heard = (
        select(
            TrialStimulus.video_id.label("video"),
            (func.count(TrialStimulus.speech) == 0).label("soundless"),
        )
        .group_by(TrialStimulus.video_id)
        .subquery()
    )
    query = _of_answered(
        select(
            Trial.id,
            Video.id,
            Video.duration,
            heard.c.soundless,
            WatchBatch.batch,
            WatchBatch.intervals,
            WatchBatch.rate,
            WatchBatch.hidden_seconds,
            WatchBatch.silent_seconds,
        )
        .join(Video, Video.trial_id == Trial.id)
        .outerjoin(heard, heard.c.video == Video.id)
        .outerjoin(WatchBatch, WatchBatch.video_id == Video.id)
    ).order_by(Trial.id, Video.id, WatchBatch.batch)
    with database.reading() as session:
        found = session.execute(query.execution_options(yield_per=ROWS)).partitions()
        rows: Iterator[tuple[Any, ...]] = (tuple(row) for block in found for row in block)
        for trial, of_trial in groupby(rows, key=itemgetter(0)):
            videos = [_video(list(each)) for _, each in groupby(of_trial, key=itemgetter(1))]
            total = sum(video.duration for video in videos)
            played = sum(length(watched_so_far(video, 0.0).intervals) for video in videos)
            yield trial, min(1.0, round(played / total, 4)) if total else math.nan


def _video(rows: list[tuple[Any, ...]]) -> _Video:
    """Return a video from its rows: one for each report, or a single one without any."""
    duration, soundless = rows[0][2:4]
    return _Video(
        duration=duration,
        soundless=bool(soundless),
        watch_batches=tuple(_Report(*row[4:]) for row in rows if row[4] is not None),
    )
