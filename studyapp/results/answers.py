"""The answers so far, of participants or a rehearsal, and the state of each arm.

They are read from a database, or from the plain files that replace it in a study from another lab.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
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
from motion.files import cell_as_given, harmless_frame, sha256_of, write_text
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
from studyapp.study.settings.sections import explain_errors
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

    A study from another lab has files instead of a database.
    """
    if folder.shared_answers.is_dir():
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
        If the study comes from another lab, with tables instead of a database.
    """
    if folder.shared_answers.is_dir():
        raise InputError(
            "this study comes from another lab, with tables instead of a database",
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


MANIFEST: Final = "answers.json"
STATED: Final = "stated.toml"
TABLES: Final = ("study_sessions", "trials", "answers", "stimuli", "looks")
MISSING: Final = "n/a"
TEXT: Final = "str"

Kind = Literal["int64", "float64", "bool", "str"]


class Manifest(BaseModel):
    """The contents of ``answers.json``.

    Attributes
    ----------
    origin : {'participants', 'rehearsal'}
        Who answered.
    motionjury : str
        The version that wrote the files.
    stated_version : int or None
        The version of ``stated.toml``, which is the study file that the first reported participant
        saw, if known.
    more_places : int
        Places of each arm beyond those of the study file.
    screened_out : dict
        Number of participants screened out, by stage.
    columns : dict
        The type of each column, by table.
    sha256 : dict
        The digest of each file.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[2] = 2
    origin: Source
    motionjury: str
    stated_version: int | None
    more_places: int
    screened_out: dict[str, int]
    columns: dict[str, dict[str, Kind]]
    sha256: dict[str, str]


def write_shared_answers(
    folder: Path,
    stored: StoredAnswers,
    *,
    origin: Source,
    stated: str | None,
    stated_version: int | None,
) -> None:
    """Write stored answers into `folder`, without tokens, codes and recruiters' ids.

    Parameters
    ----------
    stated : str or None
        Text of the study file that the first reported participant saw.
    """
    columns: dict[str, dict[str, Kind]] = {}
    for name in TABLES:
        frame: pd.DataFrame = getattr(stored, name)
        columns[name] = {str(column): _kind(frame[column]) for column in frame.columns}
        text = harmless_frame(frame).to_csv(
            index=False, na_rep=MISSING, lineterminator="\n", quoting=csv.QUOTE_MINIMAL
        )
        write_text(folder / f"{name}.csv", text)
    if stated is not None:
        write_text(folder / STATED, stated)
    manifest = Manifest(
        origin=origin,
        motionjury=metadata.version("motionjury"),
        stated_version=stated_version,
        more_places=stored.more_places,
        screened_out=dict(stored.screened_out),
        columns=columns,
        sha256={
            path.name: sha256_of(path) for path in sorted(folder.iterdir()) if path.name != MANIFEST
        },
    )
    write_text(folder / MANIFEST, manifest.model_dump_json(indent=1) + "\n")


def read_shared_answers(folder: Path, origin: Source) -> Answers:
    """Read the files of `write_shared_answers`; no answers if they are not of `origin`.

    Raises
    ------
    InputError
        If a file is missing, damaged or changed.
    """
    manifest = _read_manifest(folder / MANIFEST)
    for name, sha256 in manifest.sha256.items():
        if not (folder / name).is_file() or sha256_of(folder / name) != sha256:
            raise _changed_file(folder / name)
    tables = {name: _read_table(folder / f"{name}.csv", manifest.columns[name]) for name in TABLES}
    stated: Study | None = None
    if manifest.stated_version is not None and STATED in manifest.sha256:
        text = (folder / STATED).read_text("utf-8")
        stated = parse_version(text, manifest.stated_version)
    if manifest.origin != origin:
        return NO_ANSWERS
    stored = StoredAnswers(
        **tables, more_places=manifest.more_places, screened_out=manifest.screened_out
    )
    return Answers(origin="none" if stored.answers.empty else origin, stored=stored, stated=stated)


def _read_manifest(path: Path) -> Manifest:
    try:
        manifest = Manifest.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise _changed_file(path) from None
    except ValidationError as error:
        raise InputError(
            explain_errors(error), where=path, remedy="Get the folder again from its source"
        ) from None
    for name in TABLES:
        if name not in manifest.columns or f"{name}.csv" not in manifest.sha256:
            raise _changed_file(path.with_name(f"{name}.csv"))
    return manifest


def _changed_file(path: Path) -> InputError:
    return InputError(
        "the file is missing or was changed",
        where=path,
        remedy="Get the folder again from its source",
    )


def _kind(column: pd.Series[Any]) -> Kind:
    if pd.api.types.is_bool_dtype(column.dtype):
        return "bool"
    if pd.api.types.is_integer_dtype(column.dtype):
        return "int64"
    return "float64" if pd.api.types.is_float_dtype(column.dtype) else TEXT


def _read_table(path: Path, columns: Mapping[str, Kind]) -> pd.DataFrame:
    cells = pd.read_csv(path, dtype=str, keep_default_na=False, na_filter=False)
    return pd.DataFrame({name: _column(cells[name], kind) for name, kind in columns.items()})


def _column(cells: pd.Series[Any], kind: Kind) -> pd.Series[Any]:
    if kind == TEXT:
        return cells.map(cell_as_given)
    if kind == "bool":
        return cells == "True"
    if kind == "float64":
        numbers = [float("nan") if cell == MISSING else float(cell) for cell in cells]
        return pd.Series(numbers, dtype="float64")
    return cells.astype("int64")
