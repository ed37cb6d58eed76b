"""What a column of an exported table is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from types import MappingProxyType
from typing import Final, Literal

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


PARTICIPANT: Final = Column(
    "participant",
    "text",
    "Pseudonym of the participant: a keyed hash, the same in every export of this study; "
    "with x2 behind it in the second of a recruiter's studies that one person took part in. "
    "Without the key, which stays with the researchers, it leads back to nobody.",
)

STUDY_SESSION: Final = Column(
    "study_session",
    "integer",
    "Number of the study session, from 1 in the order of arrival; the report names "
    "participants by it.",
)

VERSION: Final = Column(
    "version", "integer", "Version of the study's design that the participant took part in, from 1."
)

ARM: Final = Column("arm", "text", "The arm of the study that the place belonged to.")

PART: Final = Column(
    "part",
    "text",
    "The set, block or task of the study that the trial belongs to.",
    missing="the study has no parts",
)

POSITION: Final = Column(
    "position",
    "integer",
    "Place of the presentation within the study session, from 1; together with the "
    "participant it names the trial.",
)

KIND: Final = Column("kind", "text", "Kind of trial.")

SEGMENT: Final = Column("segment", "text", "The speech excerpt that the trial is about.")

EXCLUSION: Final = (
    Column(
        "excluded",
        "boolean",
        "Whether the participant is left out of the analysis by a rule of the study or by "
        "a researcher.",
        missing="the rules were not applied: withdrawn, an earlier design, or nothing answered",
    ),
    Column(
        "exclusion_rule",
        "text",
        "The rule that left the participant out, the first one that applied; what "
        "researchers decide by hand comes after the study's rules.",
        missing="not left out",
    ),
    Column(
        "exclusion_kind",
        "text",
        "Whether that rule was settled before the first participant came, or a researcher decided.",
        missing="not left out",
    ),
    Column(
        "exclusion_reason",
        "text",
        "Why the rule applied to this participant.",
        missing="not left out",
        free_text=True,
    ),
)
