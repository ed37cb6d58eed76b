"""What has been answered so far, by participants or in a rehearsal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import pandas as pd

from analysis.responses import responses_frame
from motion.files import replacing
from studyapp.definition.folder import StudyFolder
from studyapp.services.database import Database, database_url_of
from studyapp.services.export import (
    EXPORT_COLUMNS,
    STUDY_SESSION_COLUMNS,
    form_answers_table,
    responses_table,
    study_sessions_table,
)
from studyapp.services.watching_export import refusals_table, watching_table

Source = Literal["participants", "rehearsal"]

BESIDE: Final[Mapping[str, Callable[[Database], pd.DataFrame]]] = {
    "form": form_answers_table,
    "watching": watching_table,
    "refusals": refusals_table,
}
"""What is exported beside the responses, each under its own name."""


@dataclass(frozen=True, eq=False)
class Answers:
    """What has been answered, and by whom.

    Attributes
    ----------
    origin : {'participants', 'rehearsal', 'none'}
        Who answered; 'none' where nobody has.
    responses : DataFrame
        Tidy responses, one row per answered question.
    study_sessions : DataFrame
        One row per study session, those without any answer included.
    """

    origin: Source | Literal["none"]
    responses: pd.DataFrame
    study_sessions: pd.DataFrame

    def opened(self) -> dict[str, int]:
        """Return how many study sessions each arm has seen."""
        return {
            str(arm): int(count) for arm, count in self.study_sessions["arm"].value_counts().items()
        }

    def completed(self) -> frozenset[str]:
        """Return the study sessions that reached the end, unplayable videos or not."""
        table = self.study_sessions
        return frozenset(table.loc[table["state"] == "completed", "study_session"])


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
    sources: tuple[Source, ...] = ("participants", "rehearsal")
    for origin in sources:
        answers = read_answers(folder, origin)
        if not answers.responses.empty:
            return answers
    return answers


def read_answers(folder: StudyFolder, origin: Source) -> Answers:
    """Return the answers of participants or of a rehearsal; the database is left as it is."""
    with _opened(folder, origin) as database:
        if database is None:
            return Answers("none", responses_frame([]), _nobody())
        responses = responses_table(database)
        study_sessions = study_sessions_table(database)
    rows = [
        dict(zip(responses.columns, row, strict=True))
        for row in responses.itertuples(index=False, name=None)
    ]
    return Answers(origin if rows else "none", responses_frame(rows), study_sessions)


def _nobody() -> pd.DataFrame:
    return pd.DataFrame(columns=list(STUDY_SESSION_COLUMNS))


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
