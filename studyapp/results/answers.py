"""The answers so far, of participants or a rehearsal, and the state of each arm.

They are read from a database, or from the file that replaces it in a study from another lab.
"""

import gzip
import zlib
from collections.abc import Iterator
from contextlib import closing, contextmanager
from importlib import metadata
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import pandas as pd
from pydantic import BaseModel, ConfigDict, ValidationError
from sqlalchemy.orm import Session

from analysis.answers.participants import EVERYBODY, ArmState
from motion.arrays import Bools
from motion.errors import InputError
from motion.files import replacing
from studyapp.database.engine import Database, database_url_of, missing_database
from studyapp.results.stated_beforehand import parse_version, stated_study
from studyapp.results.stored_answers import (
    NO_ANSWERS,
    Answers,
    Source,
    StoredAnswers,
    stored_answers,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def answers_to_report(folder: StudyFolder) -> Answers:
    """Return the real answers if there are any, else the rehearsal's, else none."""
    real = read_answers(folder, "participants")
    if real.origin != "none":
        return real
    rehearsed = read_answers(folder, "rehearsal")
    return real if rehearsed.origin == "none" else rehearsed


def read_rehearsal(folder: StudyFolder) -> Answers:
    """Return the rehearsal's answers.

    Raises
    ------
    InputError
        If there are none.
    """
    rehearsed = read_answers(folder, "rehearsal")
    if rehearsed.origin == "none":
        raise missing_answers(folder, "rehearsal")
    return rehearsed


def missing_answers(folder: StudyFolder, origin: Source) -> InputError:
    """Return the error where the answers of participants or of a rehearsal are needed."""
    if origin == "rehearsal":
        return InputError(
            "nothing has been rehearsed",
            where=folder.root,
            remedy="Run 'motionjury rehearse' first, or omit --rehearsal",
        )
    error = missing_database(database_url_of(folder.root))
    remedy = f"{error.remedy}; for simulated participants, use --rehearsal"
    return InputError(error.what, where=error.where, remedy=remedy)


def read_answers(folder: StudyFolder, origin: Source) -> Answers:
    """Return the answers of participants or of a rehearsal, without changing the database.

    A study from another lab has a file instead of a database.
    """
    if folder.shared_answers.exists():
        return _shared(folder, origin)
    with snapshot(folder, origin) as session:
        return answers_in(session, origin)


def answers_in(session: Session | None, origin: Source, *, in_full: bool = False) -> Answers:
    """Return the answers in a `snapshot`; for `in_full` see `stored_answers`."""
    if session is None:
        return NO_ANSWERS
    stored = stored_answers(session, in_full=in_full)
    sessions = stored.study_sessions
    versions = sessions.loc[has_current_design(sessions), "version"]
    stated = None if versions.empty else stated_study(session, int(versions.min()))
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)


def _shared(folder: StudyFolder, origin: Source) -> Answers:
    for database in (folder.responses, folder.rehearsal):
        if database.exists():
            raise InputError(
                "this study has both a database and answers from another lab",
                where=database,
                remedy=f"Move either the database or {folder.shared_answers} elsewhere",
            )
    return read_shared_answers(folder.shared_answers, origin)


@contextmanager
def snapshot(folder: StudyFolder, origin: Source) -> Iterator[Session | None]:
    """Yield a consistent state of the database with the answers; None if there is none.

    Raises
    ------
    InputError
        If the study comes from another lab, with a file instead of a database.
    """
    if folder.shared_answers.exists():
        raise InputError(
            "this study comes from another lab, with a file instead of a database",
            where=folder.shared_answers,
            remedy="Use the tables in the shared folder, or report the study",
        )
    url = database_url_of(folder.root, rehearsal=origin == "rehearsal")
    database = Database.open_for_reading(url)
    if database is None:
        yield None
        return
    with closing(database), database.reading() as session:
        yield session


def has_current_design(study_sessions: pd.DataFrame) -> Bools:
    """Return which study sessions have the current design of their arm.

    A new version of a study may change what participants of an arm see; earlier answers then
    belong to another design. Arms that do not change keep their participants.
    """
    latest = (
        study_sessions.sort_values(["version", "study_session"])
        .groupby("arm", sort=False)["arm_design"]
        .last()
    )
    return np.asarray(
        study_sessions["arm"].map(latest).to_numpy(object)
        == study_sessions["arm_design"].to_numpy(object),
        bool,
    )


def arm_states(study: Study, stored: StoredAnswers) -> tuple[ArmState, ...]:
    """Return the state of each arm, in the order of the study.

    Parameters
    ----------
    study : Study
        The study with its places.
    stored : StoredAnswers
        All study sessions, and the number of additional places.
    """
    sessions = stored.study_sessions
    places = {arm.name: arm.places + stored.more_places for arm in study.arms}
    names = dict.fromkeys((*places, *map(str, sessions["arm"])))
    present, withdrawn = has_current_design(sessions), sessions["withdrawn"]
    counts = (
        pd.DataFrame(
            {
                "opened": np.ones(len(sessions), bool),
                "withdrawn": withdrawn,
                "earlier": ~present & ~withdrawn,
                "unwatched": present & ~withdrawn & sessions["unwatched"],
                "completed": present & ~withdrawn & sessions["completed"],
            }
        )
        .groupby(sessions["arm"].astype(str))
        .sum()
        .reindex(list(names), fill_value=0)
    )
    states = []
    for name in names:
        count: dict[Any, int] = counts.loc[name].to_dict()
        arm = name if len(names) > 1 else EVERYBODY
        states.append(ArmState(arm=arm, places=places.get(name), **count))
    return tuple(states)


def arm_by_session(study: Study, study_sessions: pd.DataFrame) -> dict[str, str]:
    """Return the name in `arm_states` of each study session's arm."""
    arms = study_sessions["arm"].astype(str)
    names = {arm.name for arm in study.arms} | set(arms)
    single = len(names) == 1
    return {
        str(session): EVERYBODY if single else arm
        for session, arm in zip(study_sessions["study_session"].tolist(), arms, strict=True)
    }


TABLES: Final = ("study_sessions", "trials", "answers", "stimuli", "looks")


class SharedTable(BaseModel):
    """A data frame, by column: the type and the cells, None where a number is missing."""

    types: dict[str, str]
    cells: dict[str, list[Any]]


class SharedAnswers(BaseModel):
    """Stored answers for another lab, without tokens, codes and recruiters' ids.

    Attributes
    ----------
    origin : {'participants', 'rehearsal'}
        Who answered.
    motionjury : str
        The version that wrote them.
    stated : str or None
        Text of the study file that the first reported participant saw, if known.
    stated_version : int or None
        Its version.
    more_places, screened_out, tables
        See `StoredAnswers`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[3] = 3
    origin: Source
    motionjury: str
    stated: str | None
    stated_version: int | None
    more_places: int
    screened_out: dict[str, int]
    tables: dict[str, SharedTable]


def write_shared_answers(
    path: Path,
    stored: StoredAnswers,
    *,
    origin: Source,
    stated: str | None,
    stated_version: int | None,
) -> None:
    """Write stored answers into a compressed file, which has a check sum; see `SharedAnswers`."""
    frames: dict[str, pd.DataFrame] = {name: getattr(stored, name) for name in TABLES}
    shared = SharedAnswers(
        origin=origin,
        motionjury=metadata.version("motionjury"),
        stated=stated,
        stated_version=stated_version,
        more_places=stored.more_places,
        screened_out=dict(stored.screened_out),
        tables={
            name: SharedTable(types=frame.dtypes.astype(str).to_dict(), cells=frame.to_dict("list"))
            for name, frame in frames.items()
        },
    )
    with replacing(path) as draft:
        draft.write_bytes(gzip.compress(shared.model_dump_json().encode(), mtime=0))


def read_shared_answers(path: Path, origin: Source) -> Answers:
    """Read the file of `write_shared_answers`; no answers if they are not of `origin`.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    try:
        shared = SharedAnswers.model_validate_json(gzip.decompress(path.read_bytes()))
    except (OSError, EOFError, zlib.error, ValidationError):
        raise InputError(
            "the file is damaged, or of another version",
            where=path,
            remedy="Get the folder again from its source",
        ) from None
    if shared.origin != origin:
        return NO_ANSWERS
    stored = StoredAnswers(
        **{
            name: pd.DataFrame(table.cells).astype(table.types)
            for name, table in shared.tables.items()
        },
        more_places=shared.more_places,
        screened_out=shared.screened_out,
    )
    stated: Study | None = None
    if shared.stated is not None and shared.stated_version is not None:
        stated = parse_version(shared.stated, shared.stated_version)
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)
