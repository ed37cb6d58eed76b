"""The tables of an export: their rows with who is left out of the analysis, and their files."""

from collections.abc import Mapping
from dataclasses import dataclass
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

SUMMED: Final = ("hidden_seconds", "silent_seconds", "stalls", "stalled_seconds")

EXCLUSION: Final = ("excluded", "exclusion_rule", "exclusion_kind", "exclusion_reason")


@dataclass(frozen=True, kw_only=True, eq=False)
class ExportedTable:
    """A table: what its columns are, and its typed rows."""

    about: columns.TableColumns
    frame: pd.DataFrame


@dataclass(frozen=True, kw_only=True)
class Exported:
    """The result of an export.

    Attributes
    ----------
    answers : int
        Rows of the main table.
    files : tuple of Path
        All written files, the main table first.
    look : str
        A warning about interim looks; empty once all have finished.
    """

    answers: int
    files: tuple[Path, ...]
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
        If the study or its database cannot be read, there are no such answers, they contradict
        the study, the key is damaged, or the ending is unknown.
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
    with snapshot(folder, origin) as session:
        if session is None:
            raise missing_answers(folder, origin)
        if not withdrawn:
            answers = answers_in(session, origin, in_full=True)
        key = PseudonymKey.read_or_make(folder.pseudonym_key)
        tables = (
            _withdrawn_tables(session, key)
            if answers.stored is None
            else exported_tables(session, answers.stored, key, exclusions(study, answers))
        )
        if with_recruiter_ids:
            tables = (*tables, _recruiter_ids(session, key))
    look = record_look(folder, study, answers, way="export", reason=reason)
    written: list[Path] = []
    for table in tables:
        file = path.with_stem("_".join(filter(None, (path.stem, table.about.name))))
        if table.about is columns.RECRUITER_IDS:
            file = path.with_name(f"{table.about.name}.csv")
        columns.write_table(file, table.frame, table.about)
        written.append(file)
    described = [(each.about, [file.name]) for each, file in zip(tables, written, strict=True)]
    book = codebook(folder, study, origin, described)
    page = path.with_name(f"{path.stem}_codebook.md")
    write_text(page, codebook_page(book))
    write_text(page.with_suffix(".json"), as_json(book))
    return Exported(
        answers=len(tables[0].frame),
        files=(*written, page, page.with_suffix(".json")),
        look=look,
    )


def exported_tables(
    session: Session, stored: StoredAnswers, key: PseudonymKey, excluded: pd.DataFrame
) -> tuple[ExportedTable, ...]:
    """Return all tables but that of the recruiter's names, the answers first.

    Parameters
    ----------
    stored : StoredAnswers
        In full, of the same state of the database.
    excluded : DataFrame
        See `exclusions`.
    """
    watching = watching_table(session)
    answers = _with_watching(answers_table(stored), watching)
    own = [key for key in ("study_session", "part") if key in excluded]
    answers = answers.merge(excluded, on=own, how="left")
    analysed: list[Any] = [
        None if pd.isna(left_out) else (not left_out and kind in ANALYSED_KINDS)
        for left_out, kind in zip(answers["excluded"], answers["kind"], strict=True)
    ]
    answers = answers.assign(analysed=pd.Series(analysed, index=answers.index, dtype=object))
    # Of several tasks, one that leaves the participant out.
    worst_first = excluded.sort_values("excluded", ascending=False, kind="stable")
    once = worst_first.drop_duplicates("study_session")[["study_session", *EXCLUSION]]
    people = participants_table(stored).merge(once, on="study_session", how="left")
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
    sums = {name: (name, "sum") for name in ("played", "duration", *SUMMED)}
    trials = (
        shown.groupby(TRIAL, sort=False)
        .agg(watched_each=("watched_each", " ".join), rate=("rate", "max"), **sums)
        .reset_index()
    )
    trials = trials.assign(times_played=(trials["played"] / trials["duration"]).astype(float))
    trials = trials.round(dict.fromkeys(("times_played", *SUMMED), 2))
    return answers.merge(trials.drop(columns=["played", "duration"]), on=TRIAL, how="left")


def _log(session: Session) -> pd.DataFrame:
    lines = session.scalars(select(AuditLine).order_by(AuditLine.id))
    rows = [
        (line.at.isoformat(), line.event, detail_label(line), line.researcher, line.reason)
        for line in lines
    ]
    return pd.DataFrame(rows, columns=list(columns.LOG.names))


def exclusions(study: Study, answers: Answers) -> pd.DataFrame:
    """Return the columns about exclusion by `study_session`, where the rules were applied.

    Where each part of the study is judged by itself, also by `part`.
    """
    tasks = analysed_tasks(study, answers)
    if len(tasks) == 1:
        return _of_task(tasks[0])
    return pd.concat([_of_task(task).assign(part=PARTS_OF[task.protocol]) for task in tasks])


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
