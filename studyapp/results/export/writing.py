"""Writing the tables of an export with their codebook."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from motion.errors import InputError
from motion.files import write_text
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.answers import answers_in, snapshot
from studyapp.results.export.codebook import as_json, codebook, codebook_page
from studyapp.results.export.columns import (
    ANSWERS,
    ENDINGS,
    FORM,
    LOG,
    PARTICIPANTS,
    RECRUITER_IDS,
    REFUSALS,
    WATCHING,
    csv_text,
    typed,
    write_table,
)
from studyapp.results.export.tables import (
    ExportedTable,
    Judged,
    exported_tables,
    judge,
    recruiter_ids,
    withdrawn_tables,
)
from studyapp.results.looks import record_look
from studyapp.results.stored_answers import NO_ANSWERS, Source
from studyapp.study.folder import StudyFolder


def empty_tables() -> tuple[ExportedTable, ...]:
    """Return all tables without rows."""
    return tuple(
        ExportedTable(about=about, frame=typed(pd.DataFrame(), about))
        for about in (ANSWERS, PARTICIPANTS, FORM, WATCHING, REFUSALS, LOG)
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
        If the study or its database cannot be read, the key is damaged, or the ending is unknown.
    """
    if path.suffix not in ENDINGS:
        raise InputError(
            f"{path.name} ends neither in .csv nor in .parquet",
            where="--out",
            remedy="Use one of these endings",
        )
    study = folder.study()
    origin: Source = "rehearsal" if rehearsal else "participants"
    answers = NO_ANSWERS
    judged = Judged()
    names: ExportedTable | None = None
    tables = empty_tables()
    with snapshot(folder, origin) as session:
        if not withdrawn:
            answers = answers_in(session, origin, in_full=True)
            judged = judge(study, answers)
        if session is not None:
            key = PseudonymKey.read_or_make(folder.pseudonym_key)
            tables = (
                withdrawn_tables(session, key)
                if answers.stored is None
                else exported_tables(session, answers.stored, key, judged)
            )
            names = recruiter_ids(session, key) if with_recruiter_ids else None
    look = record_look(folder, study, answers, way="export", reason=reason)
    written: list[Path] = []
    described = []
    for table in tables:
        file = path.with_stem("_".join(filter(None, (path.stem, table.about.name))))
        write_table(file, table.frame, table.about)
        written.append(file)
        described.append((table.about, [file.name]))
    if names is not None:
        file = path.with_name(f"{RECRUITER_IDS.name}.csv")
        write_text(file, csv_text(names.frame, names.about), private=True)
        written.append(file)
        described.append((RECRUITER_IDS, [file.name]))
    book = codebook(folder, study, described)
    page = path.with_name(f"{path.stem}_codebook.md")
    write_text(page, codebook_page(book))
    write_text(page.with_suffix(".json"), as_json(book))
    return Exported(
        answers=len(tables[0].frame),
        files=(*written, page, page.with_suffix(".json")),
        remark=judged.remark,
        look=look,
    )
