"""A table of answers: the columns of each protocol and their cells; the checked table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import Field, TypeAdapter

if TYPE_CHECKING:
    # Serving a study reads kinds of trials, and need not wait for pandas.
    import pandas as pd

Needed = Literal["always", "analysed", "no"]

MISSING: Final = frozenset({"", "NA", "N/A", "NaN", "nan", "None", "null", "<NA>"})
"""Texts that programs write for a cell without a value."""

KINDS: Final = ("practice", "main", "repeat", "catch", "attention")

ANALYSED_KINDS: Final = ("main", "repeat")
"""Kinds of trial whose answers are analysed; practice and catch trials and attention
checks never are."""


@dataclass(frozen=True)
class Column:
    """A column of a table of answers.

    Attributes
    ----------
    name : str
        The heading.
    cells : TypeAdapter
        Validates a list of nonempty cells.
    meaning : str
        The content of a cell, in words that follow 'is not'.
    needed : {'always', 'analysed', 'no'}
        Which rows need a cell: all, those of main and repeated trials, or none.
    missing : frozenset of str
        Texts that count as an empty cell. A name may be 'NA', a number cannot.
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
    """Return a column of names."""
    missing = frozenset({""}) if required else MISSING
    return Column(name, TypeAdapter(list[str]), "a name", needed, missing, required)


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]

SHARED: Final = (
    name_column("participant", needed="always"),
    name_column("segment"),
    name_column("question"),
    name_column("trial", needed="no", required=False),
    Column(
        "kind",
        TypeAdapter(list[Literal["practice", "main", "repeat", "catch", "attention"]]),
        f"one of {', '.join(KINDS)}",
        required=False,
    ),
    name_column("set", required=False),
    name_column("emotion", needed="no", required=False),
    name_column("speaker", needed="no", required=False),
    Column(
        "response_seconds",
        TypeAdapter(list[NotNegative]),
        "a number of seconds, zero or more",
        required=False,
    ),
    Column("excluded", TypeAdapter(list[str]), "true, false or a reason", required=False),
    Column(
        "correct_side", TypeAdapter(list[Literal["left", "right"]]), "left or right", required=False
    ),
    Column(
        "instructed",
        TypeAdapter(list[NotNegative]),
        "the answer asked for, a number",
        required=False,
    ),
    Column("watched", TypeAdapter(list[Share]), "a share from 0 to 1", required=False),
)
"""Columns of every protocol."""

PREFERENCE: Final = Column(
    "response",
    TypeAdapter(list[Annotated[int, Field(ge=1, le=5)]]),
    "a whole number from 1 (strongly left) to 5 (strongly right)",
)

RATING: Final = Column(
    "response",
    TypeAdapter(list[Annotated[int, Field(ge=0, le=1000)]]),
    "a whole number from 0 to 1000",
)

RANK: Final = Column("rank", TypeAdapter(list[Positive]), "a number above zero, 1 for the best")


def speech_column(name: str) -> Column:
    """Return the column that states which speech a side was heard with."""
    return Column(name, TypeAdapter(list[Literal["own", "other"]]), "own or other", "analysed")


@dataclass(frozen=True, kw_only=True)
class Layout:
    """The columns of one protocol.

    Attributes
    ----------
    protocol : str
        The protocol's name.
    conditions : tuple of Column
        Columns that name conditions, from left to right.
    value : Column
        The column of answers.
    others : tuple of Column
        Further columns that identify what was shown.
    has_sides : bool
        Whether two videos stand side by side, so that a catch trial has a correct side.
    answered_once : bool
        Whether a participant answers a question about a segment's condition only once, so that rows
        belong together without a trial number.
    distinct : (str, str) or None
        Two columns that differ in every row of main and repeated trials.
    contradiction : str
        The error message for a row in which they do not.
    """

    protocol: str
    conditions: tuple[Column, ...]
    value: Column
    others: tuple[Column, ...] = ()
    has_sides: bool
    answered_once: bool = False
    distinct: tuple[str, str] | None = None
    contradiction: str = ""

    @property
    def columns(self) -> tuple[Column, ...]:
        """All columns of this protocol alone."""
        return (*self.conditions, *self.others, self.value)


PAIRWISE: Final = Layout(
    protocol="pairwise",
    conditions=(name_column("left"), name_column("right")),
    value=PREFERENCE,
    has_sides=True,
    distinct=("left", "right"),
    contradiction="left and right are the same condition",
)

RATING_OF_ONE: Final = Layout(
    protocol="rating",
    conditions=(name_column("condition"),),
    value=RATING,
    has_sides=False,
)

RANKING: Final = Layout(
    protocol="ranking",
    conditions=(name_column("condition"),),
    value=RANK,
    has_sides=False,
    answered_once=True,
)

MISMATCH: Final = Layout(
    protocol="mismatch",
    conditions=(name_column("condition"),),
    value=PREFERENCE,
    others=(speech_column("left_speech"), speech_column("right_speech")),
    has_sides=True,
    distinct=("left_speech", "right_speech"),
    contradiction="left_speech and right_speech are the same; one is own, the other is other",
)

LAYOUTS: Final[Mapping[str, Layout]] = {
    layout.protocol: layout for layout in (PAIRWISE, RATING_OF_ONE, RANKING, MISMATCH)
}
"""Layouts by protocol, as the command line names them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AnswerTable:
    """A table of answers that has been checked.

    Attributes
    ----------
    protocol : str
        The protocol of the answers.
    answers : DataFrame
        One row for each answer of practice, main, repeated and catch trials, and of attention
        checks that say what they ask for: `participant`, `segment`, `question`, `set`, `kind`,
        `trial`, `correct_side` and the protocol's columns as categories, NaN where a cell is empty;
        `value`, the answer; `instructed`, the answer that an attention check asks for; `seconds`,
        the response time; `watched`, the share of the trial's videos that was watched before
        answering, in [0, 1]; NaN if unknown.
    participants : tuple of str
        All participants in the table, in the order of appearance.
    marked : dict of str to str
        Why participants are marked as excluded.
    conditions, questions, sets : tuple of str
        Names in main and repeated trials, in the order of appearance in the table; without a column
        of sets, the only set is ''.
    notes : tuple of str
        Sentences about rows that are not analysed, or that look like slips.
    scales : mapping of str to (int, int)
        The lowest and the highest rating that each question allows, if known.
    """

    protocol: str
    answers: pd.DataFrame
    participants: tuple[str, ...]
    marked: dict[str, str]
    conditions: tuple[str, ...]
    questions: tuple[str, ...]
    sets: tuple[str, ...]
    notes: tuple[str, ...]
    scales: Mapping[str, tuple[int, int]] = field(default_factory=dict)

    @property
    def has_sets(self) -> bool:
        """Whether the answers are divided into sets."""
        return self.sets not in ((), ("",))

    def limits(self, question: str) -> tuple[float, float]:
        """Return the lowest and highest possible rating; infinite unless the scale is stated."""
        return self.scales.get(question, (-math.inf, math.inf))

    @property
    def shown(self) -> pd.DataFrame:
        """Answers of practice, main and repeated trials."""
        return self.answers[~self.answers["kind"].isin(["catch", "attention"])]
