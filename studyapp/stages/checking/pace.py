"""How fast people really were, in this study or in a pilot of it."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import Final

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.services.database import Database, database_url_of, sqlite_url
from studyapp.services.sitting_times import finished_seconds
from studyapp.stages.checking.expected_time import expected_time
from studyapp.stages.checking.material import Material

FEWEST: Final = 3
"""With fewer who have finished, their pace is chance."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """What those tell who have finished.

    Attributes
    ----------
    finished : int
    minutes : float
        The median of what they took, as recruiting sites reckon.
    times_expected : float
        The same by what was expected of the study that they took.
    source : str
        Whose it is, in words.
    """

    finished: int
    minutes: float
    times_expected: float
    source: str


def pace_of_study(material: Material) -> Pace | None:
    """Return the pace of who has finished this study; None where that tells nothing."""
    return _pace(material, database_url_of(material.folder.root), "this study")


def pace_of_pilot(folder: StudyFolder) -> Pace:
    """Return the pace of who has finished a pilot.

    Raises
    ------
    InputError
        If it cannot be read, or too few have finished it.
    """
    pilot = Material.of(folder, folder.study())
    found = _pace(pilot, sqlite_url(folder.responses), f"the pilot {folder.root.name}")
    if found is None:
        raise InputError(
            f"fewer than {FEWEST} participants have finished the pilot, so that it tells no pace",
            where=folder.responses,
            remedy="Name a study that people have taken, or leave --pilot away",
        )
    return found


def _pace(material: Material, url: str, source: str) -> Pace | None:
    expected = expected_time(material)
    database = Database.open_for_reading(url)
    if database is None or expected is None:
        return None
    try:
        took = finished_seconds(database)
    finally:
        database.close()
    if len(took) < FEWEST:
        return None
    middle = median(took)
    return Pace(
        finished=len(took),
        minutes=middle / 60,
        times_expected=middle / expected.seconds,
        source=source,
    )
