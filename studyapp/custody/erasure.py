"""Erasing a participant of a study: what is known, what goes, and what is left to do by hand."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from studyapp.clock import Clock
from studyapp.custody.forgetting import Remembered, forget, has_forgotten, remembered
from studyapp.database.engine import Database, database_url_of
from studyapp.database.scrubbing import leave_nothing
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.study.folder import StudyFolder


def remembered_of(folder: StudyFolder, name: str) -> tuple[Remembered, ...]:
    """Return what is stored of the participant called `name`; the database is left as it is."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return ()
    try:
        return remembered(database, name, PseudonymKey.read(folder.pseudonym_key))
    finally:
        database.close()


def forget_participant(folder: StudyFolder, name: str) -> int:
    """Erase the participant called `name`, and return how many entries of `remembered_of` went.

    The database's files are written anew, also where an earlier run was kept from it.

    Raises
    ------
    InputError
        If the files cannot be written anew; the participant is erased all the same.
    """
    with _opened(folder) as database:
        if database is None:
            return 0
        key = PseudonymKey.read(folder.pseudonym_key)
        count = forget(database, name, key, Clock())
        if count or has_forgotten(database):
            leave_nothing(database)
    return count


def copies_to_mend(folder: StudyFolder) -> tuple[str, ...]:
    """Return the files beside the study that may still hold a participant, as they are called."""
    tables = sorted(
        path.name
        for path in folder.root.glob("*")
        if path.suffix in (".csv", ".parquet") and path.is_file() and path.name != "metrics.parquet"
    )
    return (*tables, *(["report/"] if folder.report.exists() else []))


@contextmanager
def _opened(folder: StudyFolder) -> Iterator[Database | None]:
    """Give the database to be written to; None where there is none, which makes none."""
    url = database_url_of(folder.root)
    there = Database.open_for_reading(url)
    if there is None:
        yield None
        return
    there.close()
    database = Database.open(url)
    try:
        yield database
    finally:
        database.close()
