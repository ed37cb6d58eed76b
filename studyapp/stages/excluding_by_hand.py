"""Excluding a participant of a study from the analysis, and reinstating one, by name."""

from __future__ import annotations

from contextlib import closing

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.definition.folder import StudyFolder
from studyapp.services.database import Database, database_url_of
from studyapp.services.exclusion_decisions import decide_exclusion
from studyapp.services.monitoring.naming import number_called
from studyapp.services.pseudonyms import PseudonymKey
from studyapp.stages.answers import snapshot


def decide_about(folder: StudyFolder, name: str, *, excluded: bool, reason: str) -> int:
    """Leave a participant out of the analysis, or take one in again; return the study session.

    Parameters
    ----------
    name : str
        The number of the study session, or the participant's pseudonym.

    Raises
    ------
    InputError
        If nobody is called so, no reason is given, it is so already, or the study was passed on
        by another lab.
    """
    with snapshot(folder, "participants") as session:
        number = None
        if session is not None:
            number = number_called(session, PseudonymKey.read(folder.pseudonym_key), name)
    if number is None:
        raise InputError(
            f"no study session is called {name!r}",
            where=folder.root,
            remedy="Give its number, as reports and researchers' pages have it, or the "
            "participant's pseudonym from an export",
        )
    with closing(Database.open(database_url_of(folder.root))) as database:
        decide_exclusion(database, Clock(), number, excluded=excluded, by="", reason=reason)
    return number
