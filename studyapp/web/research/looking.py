"""Whose data a page shows: those of participants, or those of the rehearsal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, Literal

from flask import abort

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.study.folder import StudyFolder
from studyapp.web.running import running

Data = Literal["study", "rehearsal"]

PREFIXES: Final[dict[Data, str]] = {"study": "", "rehearsal": "/rehearsal"}
"""What the addresses of their pages begin with."""


@contextmanager
def looked_at(data: Data) -> Iterator[Database]:
    """Give the database of `data`; that of the rehearsal can only be read.

    Where nothing has been rehearsed, the page does not exist.

    Raises
    ------
    InputError
        If the rehearsal's database cannot be read.
    """
    here = running()
    if data == "study":
        yield here.database
        return
    try:
        rehearsed = Database.open_for_reading(sqlite_url(StudyFolder(here.folder).rehearsal))
    except InputError as error:
        raise InputError(
            "the rehearsal cannot be read: it is damaged, or of another version of Motion Jury",
            remedy="Run 'motionjury rehearse' again",
        ) from error
    if rehearsed is None:
        abort(404)
    try:
        yield rehearsed
    finally:
        rehearsed.close()


def is_rehearsed() -> bool:
    """Tell whether there is a rehearsal to be looked at."""
    return StudyFolder(running().folder).rehearsal.exists()
