"""What has been answered so far, by participants or in a rehearsal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import pandas as pd

from motion.files import replacing
from studyapp.definition.folder import StudyFolder
from studyapp.definition.study import Study
from studyapp.services.database import Database, database_url_of
from studyapp.services.export import (
    EXPORT_COLUMNS,
    form_answers_table,
    responses_table,
)
from studyapp.services.stated_study import stated_study
from studyapp.services.stored_answers import StoredAnswers, stored_answers
from studyapp.services.watching_export import refusals_table, watching_table
from studyapp.stages.report_arms import of_present_design

Source = Literal["participants", "rehearsal"]

BESIDE: Final[Mapping[str, Callable[[Database], pd.DataFrame]]] = {
    "form": form_answers_table,
    "watching": watching_table,
    "refusals": refusals_table,
}
"""What is exported beside the responses, each under its own name."""


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


def export(
    folder: StudyFolder, path: Path, *, rehearsal: bool = False, withdrawn: bool = False
) -> int:
    """Write the real responses, or the rehearsal's, as tidy CSV and return their number.

    Beside it go ``<name>_form.csv``, what participants said about themselves;
    ``<name>_watching.csv``, how each video was watched; and ``<name>_refusals.csv``, requests
    that were refused. One that would be empty is only written over an earlier one.

    With `withdrawn`, what was kept of participants who withdrew is written instead: their answers,
    and what they said about themselves.
    """
    table = pd.DataFrame(columns=list(EXPORT_COLUMNS))
    beside: dict[str, pd.DataFrame] = {}
    with _opened(folder, "rehearsal" if rehearsal else "participants") as database:
        if database is not None:
            table = responses_table(database, withdrawn=withdrawn)
            beside = (
                {"form": form_answers_table(database, withdrawn=True)}
                if withdrawn
                else {name: read(database) for name, read in BESIDE.items()}
            )
    _write(path, table)
    for name, other in beside.items():
        file = path.with_name(f"{path.stem}_{name}.csv")
        if not other.empty or file.exists():
            _write(file, other)
    return len(table)


def answers_to_report(folder: StudyFolder) -> Answers:
    """Return the real answers where there are any, else the rehearsal's, else none."""
    real = read_answers(folder, "participants")
    if real.origin != "none":
        return real
    rehearsed = read_answers(folder, "rehearsal")
    return real if rehearsed.origin == "none" else rehearsed


def read_answers(folder: StudyFolder, origin: Source) -> Answers:
    """Return the answers of participants or of a rehearsal; the database is left as it is."""
    with _opened(folder, origin) as database:
        if database is None:
            return Answers(origin="none", stored=None, stated=None)
        stored = stored_answers(database)
        sessions = stored.study_sessions
        versions = sessions.loc[of_present_design(sessions), "version"]
        stated = None if versions.empty else stated_study(database, int(versions.min()))
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)


@contextmanager
def _opened(folder: StudyFolder, origin: Source) -> Iterator[Database | None]:
    """Give the database that holds the answers, to be read; None where there is none yet."""
    url = database_url_of(folder.root, rehearsal=origin == "rehearsal")
    database = Database.open_for_reading(url)
    try:
        yield database
    finally:
        if database is not None:
            database.close()


def _write(path: Path, table: pd.DataFrame) -> None:
    with replacing(path) as draft:
        table.to_csv(draft, index=False, lineterminator="\n")
