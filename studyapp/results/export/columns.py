"""What a column of an exported table is; `columns.toml` declares them all."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, Final, Literal

ColumnType = Literal["text", "integer", "number", "boolean", "moment"]

DTYPES: Final[Mapping[ColumnType, str]] = MappingProxyType(
    {
        "text": "string",
        "integer": "Int64",
        "number": "Float64",
        "boolean": "boolean",
        "moment": "datetime64[us, UTC]",
    }
)
"""How each type is held; every one knows missing values."""


@dataclass(frozen=True)
class Column:
    """One column of an exported table.

    Attributes
    ----------
    name : str
        Its heading.
    type : ColumnType
        ``moment`` is ISO 8601 in UTC in CSV, a timestamp in Parquet.
    meaning : str
        As a sentence or two.
    unit : str
        Empty where there is none.
    missing : str
        When a cell is empty, in words; empty where none ever is.
    free_text : bool
        Whether people wrote it, so that it may name somebody.
    """

    name: str
    type: ColumnType
    meaning: str
    _: KW_ONLY
    unit: str = ""
    missing: str = ""
    free_text: bool = False


@dataclass(frozen=True, kw_only=True)
class TableColumns:
    """The columns of one exported table.

    Attributes
    ----------
    name : str
        What its file is called after; empty for the main table.
    title : str
        What one row is.
    columns : tuple of Column
        In their order, which does not change.
    """

    name: str
    title: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The headings."""
        return tuple(column.name for column in self.columns)


@cache
def _declared() -> Mapping[str, Any]:
    """Return what `columns.toml` says."""
    return tomllib.loads(files(__package__).joinpath("columns.toml").read_text("utf-8"))


def _table(name: str) -> TableColumns:
    """Return the columns of a table, as they are declared."""
    declared = _declared()[name]
    own = _declared()["several"] | declared["columns"]
    return TableColumns(
        name="" if name == "answers" else name,
        title=declared["row"],
        columns=tuple(Column(column, **own[column]) for column in declared["order"]),
    )


def fixed_values(column: str) -> Mapping[str, str] | None:
    """Return the values of a column that are the same in every study; None where none are."""
    found: Mapping[str, str] | None = _declared()["values"].get(column)
    return found


def preference_values(*, strength: bool) -> Mapping[str, str]:
    """Return what answers between two stimuli mean, by how far they are from 0."""
    found: Mapping[str, str] = _declared()["preferences"]["strong" if strength else "plain"]
    return found


def bids_column(column: Column) -> Column:
    """Return `column` as BIDS names it; moments are seconds since the participant's consent."""
    return replace(column, **_declared()["bids"].get(column.name, {}))


ANSWERS, PARTICIPANTS, FORM, WATCHING, REFUSALS, LOG, RECRUITER_IDS = map(
    _table, ("answers", "participants", "form", "watching", "refusals", "log", "recruiter_ids")
)
PARTICIPANT: Final = PARTICIPANTS.columns[0]
