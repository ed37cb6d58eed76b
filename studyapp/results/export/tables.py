"""The tables of an export: their rows with who is left out of the analysis, and their files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.exclusion_rules import BY_HAND, RuleOutcome
from analysis.answers.table import ANALYSED_KINDS
from motion.errors import InputError
from motion.files import write_text
from studyapp.database.tables.researchers import AuditLine
from studyapp.database.tables.study_session import StudySession
from studyapp.researchers.audit import detail_label
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.analysed_tasks import PARTS_OF, AnalysedTask, analysed_tasks
from studyapp.results.answers import answers_in, missing_answers, snapshot
from studyapp.results.export import columns
from studyapp.results.export.codebook import as_json, codebook, codebook_page
from studyapp.results.export.rows import (
    answers_table,
    form_answers_table,
    participants_table,
    refusals_table,
    watching_table,
)
from studyapp.results.looks import record_look
from studyapp.results.stored_answers import (
    NO_ANSWERS,
    Answers,
    Source,
    StoredAnswers,
    stored_answers,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

TRIAL: Final = ["study_session", "position"]

EXCLUSION: Final = ("excluded", "exclusion_rule", "exclusion_kind", "exclusion_reason")


@dataclass(frozen=True, kw_only=True, eq=False)
class ExportedTable:
    """A table: what its columns are, and its typed rows."""

    about: columns.TableColumns
    frame: pd.DataFrame


@dataclass(frozen=True, kw_only=True, eq=False)
class Judged:
    """What the rules of a study say of each participant.

    Attributes
    ----------
    rows : DataFrame
        The columns about exclusion by `study_session`, and by `part` where each part of the study
        is judged by itself. Study sessions that the rules were not applied to are not there.
    remark : str
        Why the rules were applied to nobody, as a sentence; empty where they were.
    """

    rows: pd.DataFrame = field(
        default_factory=lambda: pd.DataFrame(columns=["study_session", *EXCLUSION], dtype=object)
    )
    remark: str = ""

    def mark_answers(self, answers: pd.DataFrame) -> pd.DataFrame:
        """Return `answers` with the columns about exclusion; of a task, by its own rules."""
        keys = [key for key in ("study_session", "part") if key in self.rows]
        return answers.merge(self.rows, on=keys, how="left")

    def mark_participants(self, participants: pd.DataFrame) -> pd.DataFrame:
        """Return `participants` with the same columns: of a task that leaves them out, if any."""
        worst_first = self.rows.sort_values("excluded", ascending=False, kind="stable")
        once = worst_first.drop_duplicates("study_session")
        return participants.merge(
            once[["study_session", *EXCLUSION]], on="study_session", how="left"
        )


@dataclass(frozen=True, kw_only=True)
class Exported:
    """The result of an export.

    Attributes
    ----------
    answers : int
        Rows of the main table.
    files : tuple of Path
        All written files, the main table first.
    remark : str
        What could not be done, as a sentence; may be empty.
    look : str
        A warning about interim looks; empty once all have finished.
    """

    answers: int
    files: tuple[Path, ...]
    remark: str = ""
    look: str = ""


def export(
    folder: StudyFolder,
    path: Path,
    *,
    rehearsal: bool = False,
    withdrawn: bool = False,
    with_recruiter_ids: bool = False,
    reason: str = "",
) -> Exported:
    """Write the real answers, or the rehearsal's, as tidy tables with a codebook.

    Beside the main table are ``<name>_participants``, ``<name>_form``, ``<name>_watching``,
    ``<name>_refusals``, ``<name>_log``, and ``<name>_codebook.md`` and ``.json``. A pseudonym key
    is created if there is none.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    path : Path
        The main table; its ending, ``.csv`` or ``.parquet``, is that of all tables.
    withdrawn : bool
        Export the remaining data of participants who withdrew instead.
    with_recruiter_ids : bool
        Also write ``recruiter_ids.csv``, which identifies people and is private to its owner.
    reason : str
        The reason in the log of looks.

    Raises
    ------
    InputError
        If the study or its database cannot be read, there are no such answers, the key is
        damaged, or the ending is unknown.
    """
    if path.suffix not in columns.ENDINGS:
        raise InputError(
            f"{path.name} ends neither in .csv nor in .parquet",
            where="--out",
            remedy="Use one of these endings",
        )
    study = folder.study()
    origin: Source = "rehearsal" if rehearsal else "participants"
    answers = NO_ANSWERS
    judged = Judged()
    with snapshot(folder, origin) as session:
        if session is None:
            raise missing_answers(folder, origin)
        if not withdrawn:
            answers = answers_in(session, origin, in_full=True)
            judged = judge(study, answers)
        key = PseudonymKey.read_or_make(folder.pseudonym_key)
        tables = (
            _withdrawn_tables(session, key)
            if answers.stored is None
            else exported_tables(session, answers.stored, key, judged)
        )
        names = _recruiter_ids(session, key) if with_recruiter_ids else None
    look = record_look(folder, study, answers, way="export", reason=reason)
    written: list[Path] = []
    described = []
    for table in tables:
        file = path.with_stem("_".join(filter(None, (path.stem, table.about.name))))
        columns.write_table(file, table.frame, table.about)
        written.append(file)
        described.append((table.about, [file.name]))
    if names is not None:
        file = path.with_name(f"{columns.RECRUITER_IDS.name}.csv")
        write_text(file, columns.csv_text(names.frame, names.about), private=True)
        written.append(file)
        described.append((columns.RECRUITER_IDS, [file.name]))
    book = codebook(folder, study, origin, described)
    page = path.with_name(f"{path.stem}_codebook.md")
    write_text(page, codebook_page(book))
    write_text(page.with_suffix(".json"), as_json(book))
    return Exported(
        answers=len(tables[0].frame),
        files=(*written, page, page.with_suffix(".json")),
        remark=judged.remark,
        look=look,
    )


def exported_tables(
    session: Session, stored: StoredAnswers, key: PseudonymKey, judged: Judged
) -> tuple[ExportedTable, ...]:
    """Return all tables but that of the recruiter's names, the answers first.

    `stored` is in full, of the same state of the database.
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
        _table(columns.ANSWERS, answers, names),
        _table(columns.PARTICIPANTS, people, names),
        _table(columns.FORM, form, names),
        _table(columns.WATCHING, watching, names),
        _table(columns.REFUSALS, refusals, names),
        ExportedTable(about=columns.LOG, frame=columns.typed(_log(session), columns.LOG)),
    )


def _withdrawn_tables(session: Session, key: PseudonymKey) -> tuple[ExportedTable, ...]:
    """Return what was kept of participants who withdrew; no rule is applied to it."""
    answers = answers_table(stored_answers(session, withdrawn=True, in_full=True))
    form = form_answers_table(session, withdrawn=True)
    names = pseudonyms(session, key)
    return (_table(columns.ANSWERS, answers, names), _table(columns.FORM, form, names))


def _recruiter_ids(session: Session, key: PseudonymKey) -> ExportedTable:
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
    frame = pd.DataFrame(
        session.execute(query).all(), columns=list(columns.RECRUITER_IDS.names[1:])
    )
    return _table(columns.RECRUITER_IDS, frame, pseudonyms(session, key))


def pseudonyms(session: Session, key: PseudonymKey) -> Mapping[str, str]:
    """Return the pseudonym of each study session, by its number as text."""
    named = key.pseudonyms(session.scalars(select(StudySession)))
    return {str(number): name for number, name in named.items()}


def _table(
    about: columns.TableColumns, frame: pd.DataFrame, names: Mapping[str, str]
) -> ExportedTable:
    named = frame.assign(participant=frame["study_session"].astype(str).map(names))
    return ExportedTable(about=about, frame=columns.typed(named, about))


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
        (line.at.isoformat(), line.event, detail_label(line), line.researcher, line.reason)
        for line in lines
    ]
    return pd.DataFrame(rows, columns=list(columns.LOG.names))


def judge(study: Study, answers: Answers) -> Judged:
    """Apply the rules of `study`; what cannot be judged is exported all the same."""
    try:
        tasks = analysed_tasks(study, answers)
    except InputError as error:
        return Judged(remark=f"The exclusion rules could not be applied: {error}")
    if len(tasks) == 1:
        return Judged(rows=_of_task(tasks[0]))
    return Judged(
        rows=pd.concat([_of_task(task).assign(part=PARTS_OF[task.protocol]) for task in tasks])
    )


def _of_task(task: AnalysedTask) -> pd.DataFrame:
    left_out = task.left_out
    rows: list[tuple[object, ...]] = []
    for who in map(str, task.table.participants):
        if who in left_out.exclusions:
            rule = left_out.rules[left_out.removed_by[who]]
            rows.append((int(who), True, rule.rule, _kind(rule), left_out.exclusions[who]))
        else:
            rows.append((int(who), False, "", "", ""))
    return pd.DataFrame(rows, columns=["study_session", *EXCLUSION]).astype(
        dict.fromkeys(("study_session", "excluded"), object)
    )


def _kind(rule: RuleOutcome) -> str:
    if rule.rule == BY_HAND:
        return "by hand"
    return "exploratory" if rule.exploratory else "planned"
