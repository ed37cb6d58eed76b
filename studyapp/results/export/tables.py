"""The tables of an export, from the study's database."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.columns import ANALYSED_KINDS
from studyapp.database.tables import AuditLine, StudySession
from studyapp.researchers.audit import told_detail
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.columns import (
    ANSWERS,
    FORM,
    LOG,
    PARTICIPANTS,
    RECRUITER_IDS,
    REFUSALS,
    WATCHING,
    TableColumns,
)
from studyapp.results.export.exclusion import Judged
from studyapp.results.export.rows import (
    answers_table,
    form_answers_table,
    participants_table,
    refusals_table,
    watching_table,
)
from studyapp.results.export.typed import typed
from studyapp.results.stored_answers import StoredAnswers, stored_answers

TRIAL: Final = ["study_session", "position"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ExportedTable:
    """A table, with what its columns are.

    Attributes
    ----------
    about : TableColumns
        Its columns.
    frame : DataFrame
        Its rows, typed.
    """

    about: TableColumns
    frame: pd.DataFrame


def exported_tables(
    session: Session, stored: StoredAnswers, key: PseudonymKey, judged: Judged
) -> tuple[ExportedTable, ...]:
    """Return all tables but that of the recruiter's names, the answers first.

    Parameters
    ----------
    stored : StoredAnswers
        In full, of the same state of the database.
    """
    watching = watching_table(session)
    answers = judged.mark_answers(_with_watching(answers_table(stored), watching))
    analysed: list[Any] = [
        None if pd.isna(excluded) else (not excluded and kind in ANALYSED_KINDS)
        for excluded, kind in zip(answers["excluded"], answers["kind"], strict=True)
    ]
    answers = answers.assign(analysed=pd.Series(analysed, index=answers.index, dtype=object))
    people = judged.mark_participants(participants_table(stored))
    form, refusals = form_answers_table(session), refusals_table(session)
    names = pseudonyms(session, key)
    return (
        _table(ANSWERS, answers, names),
        _table(PARTICIPANTS, people, names),
        _table(FORM, form, names),
        _table(WATCHING, watching, names),
        _table(REFUSALS, refusals, names),
        ExportedTable(about=LOG, frame=typed(_log(session), LOG)),
    )


def withdrawn_tables(session: Session, key: PseudonymKey) -> tuple[ExportedTable, ...]:
    """Return what was kept of participants who withdrew; no rule is applied to it."""
    answers = answers_table(stored_answers(session, withdrawn=True, in_full=True))
    form = form_answers_table(session, withdrawn=True)
    names = pseudonyms(session, key)
    return (_table(ANSWERS, answers, names), _table(FORM, form, names))


def recruiter_ids(session: Session, key: PseudonymKey) -> ExportedTable:
    """Return the table of the recruiter's names; it is never written with the others."""
    query = (
        select(
            StudySession.id.label("study_session"),
            StudySession.recruiter_participant,
            StudySession.recruiter_study,
            StudySession.recruiter_session,
        )
        .where(StudySession.recruiter_participant.is_not(None))
        .order_by(StudySession.id)
    )
    frame = pd.DataFrame(session.execute(query).all(), columns=list(RECRUITER_IDS.names[1:]))
    return _table(RECRUITER_IDS, frame, pseudonyms(session, key))


def pseudonyms(session: Session, key: PseudonymKey) -> Mapping[str, str]:
    """Return the pseudonym of each study session, by its number as text."""
    named = key.pseudonyms(session.scalars(select(StudySession)))
    return {str(number): name for number, name in named.items()}


def _table(about: TableColumns, frame: pd.DataFrame, names: Mapping[str, str]) -> ExportedTable:
    named = frame.assign(participant=frame["study_session"].astype(str).map(names))
    return ExportedTable(about=about, frame=typed(named, about))


def _with_watching(answers: pd.DataFrame, watching: pd.DataFrame) -> pd.DataFrame:
    """Return answers with what was reported of all videos of their trial."""
    shown = watching.assign(
        watched_each=watching["watched"].map(str),
        played=watching["times_played"] * watching["duration"],
    )
    trials = (
        shown.groupby(TRIAL, sort=False)
        .agg(
            watched_each=("watched_each", " ".join),
            played=("played", "sum"),
            duration=("duration", "sum"),
            rate=("rate", "max"),
            hidden_seconds=("hidden_seconds", "sum"),
            silent_seconds=("silent_seconds", "sum"),
            stalls=("stalls", "sum"),
            stalled_seconds=("stalled_seconds", "sum"),
        )
        .reset_index()
        if len(shown)
        else pd.DataFrame(columns=[*TRIAL, "played", "duration"])
    )
    trials["times_played"] = (trials["played"] / trials["duration"]).astype(float).round(2)
    for name in ("hidden_seconds", "silent_seconds", "stalled_seconds"):
        if name in trials:
            trials[name] = trials[name].round(2)
    return answers.merge(trials.drop(columns=["played", "duration"]), on=TRIAL, how="left")


def _log(session: Session) -> pd.DataFrame:
    lines = session.scalars(select(AuditLine).order_by(AuditLine.id))
    rows = [
        (line.at.isoformat(), line.event, told_detail(line), line.researcher, line.reason)
        for line in lines
    ]
    return pd.DataFrame(rows, columns=list(LOG.names))
