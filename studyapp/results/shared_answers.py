"""A study's answers as plain files, which replace the database for a report."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any, Final, Literal

import pandas as pd
from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import cell_as_given, harmless_frame, sha256_of, write_text
from studyapp.results.stated_beforehand import parse_version
from studyapp.results.stored_answers import NO_ANSWERS, Answers, Source, StoredAnswers
from studyapp.study.settings.sections import explain_errors
from studyapp.study.settings.study import Study

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
