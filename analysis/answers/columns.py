"""Columns that a table of answers may have, and what their cells may hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal

from pydantic import Field, TypeAdapter

Needed = Literal["always", "analysed", "no"]

MISSING: Final = frozenset({"", "NA", "N/A", "NaN", "nan", "None", "null", "<NA>"})
"""What programs write for a cell without a value."""

KINDS: Final = ("practice", "main", "repeat", "catch", "attention")

ANALYSED_KINDS: Final = ("main", "repeat")
"""Kinds of trial whose answers are analysed; practice and catch trials and attention
checks never are."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column.

    Attributes
    ----------
    name : str
        Its heading.
    cells : TypeAdapter
        Reads a list of cells that are not empty.
    meaning : str
        What a cell holds, in words that follow 'is not'.
    needed : {'always', 'analysed', 'no'}
        Which rows need a cell: all, those of main and repeated trials, or none.
    missing : frozenset of str
        What counts as an empty cell. A name may well be 'NA', a number cannot.
    required : bool
        Whether every table has the column.
    """

    name: str
    cells: TypeAdapter[list[Any]]
    meaning: str
    needed: Needed = "no"
    missing: frozenset[str] = MISSING
    required: bool = True


def name_column(name: str, *, needed: Needed = "analysed", required: bool = True) -> Column:
    """Return a column that names something."""
    return Column(
        name=name,
        cells=TypeAdapter(list[str]),
        meaning="a name",
        needed=needed,
        missing=frozenset({""}) if required else MISSING,
        required=required,
    )


_KIND: Final = Column(
    name="kind",
    cells=TypeAdapter(list[Literal["practice", "main", "repeat", "catch", "attention"]]),
    meaning=f"one of {', '.join(KINDS)}",
    required=False,
)

_CORRECT_SIDE: Final = Column(
    name="correct_side",
    cells=TypeAdapter(list[Literal["left", "right"]]),
    meaning="left or right",
    required=False,
)

_SECONDS: Final = Column(
    name="response_seconds",
    cells=TypeAdapter(list[Annotated[float, Field(ge=0, allow_inf_nan=False)]]),
    meaning="a number of seconds, zero or more",
    required=False,
)

_INSTRUCTED: Final = Column(
    name="instructed",
    cells=TypeAdapter(list[Annotated[float, Field(ge=0, allow_inf_nan=False)]]),
    meaning="the answer asked for, a number",
    required=False,
)

_WATCHED: Final = Column(
    name="watched",
    cells=TypeAdapter(list[Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]]),
    meaning="a share from 0 to 1",
    required=False,
)

SHARED: Final = (
    name_column("participant", needed="always"),
    name_column("segment"),
    name_column("question"),
    name_column("trial", needed="no", required=False),
    _KIND,
    name_column("set", required=False),
    name_column("emotion", needed="no", required=False),
    name_column("speaker", needed="no", required=False),
    _SECONDS,
    Column(
        name="excluded",
        cells=TypeAdapter(list[str]),
        meaning="true, false or a reason",
        required=False,
    ),
    _CORRECT_SIDE,
    _INSTRUCTED,
    _WATCHED,
)
"""Columns of every protocol."""

PREFERENCE: Final = Column(
    name="response",
    cells=TypeAdapter(list[Annotated[int, Field(ge=1, le=5)]]),
    meaning="a whole number from 1 (strongly left) to 5 (strongly right)",
)

RATING: Final = Column(
    name="response",
    cells=TypeAdapter(list[Annotated[int, Field(ge=0, le=1000)]]),
    meaning="a whole number from 0 to 1000",
)

RANK: Final = Column(
    name="rank",
    cells=TypeAdapter(list[Annotated[float, Field(gt=0, allow_inf_nan=False)]]),
    meaning="a number above zero, 1 for the best",
)


def speech_column(name: str) -> Column:
    """Return the column that tells which speech a side was heard with."""
    return Column(
        name=name,
        cells=TypeAdapter(list[Literal["own", "other"]]),
        meaning="own or other",
        needed="analysed",
    )
