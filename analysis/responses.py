"""The tidy table of responses: one row per answered question of one trial.

The study app exports it, the statistics read it. Whatever enters is checked against `Response`,
so that everything behind this module may trust its columns.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

import pandas as pd
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field, ValidationError, model_validator

from analysis.trial_kinds import ANALYSED_KINDS as ANALYSED_KINDS
from motion.errors import InputError

Name = Annotated[str, Field(min_length=1)]


class Response(BaseModel):
    """One answer to one question of one trial.

    Attributes
    ----------
    study_session : str
        The participant's sitting; one participant has one.
    comparison : str
        The pair of conditions that this participant compares.
    reference, other : str
        The two conditions shown; of a catch trial, `other` is the visibly broken one.
    segment, emotion, speaker : str
        The speech excerpt heard, its emotion label and who speaks.
    kind : {'practice', 'main', 'repeat', 'catch', 'attention'}
        Practice is discarded, repeat is analysed like main, catch and attention only serve
        exclusions.
    position : int
        Place of the trial within the study session, from 1.
    question : str
        Name of the question.
    left_condition, right_condition : str
        What was shown on which side.
    value : int
        -2 clearly left, -1 slightly left, 0 no difference, 1 slightly right, 2 clearly right.
    expected : {'left', 'right', ''}
        The right answer of a catch trial; empty for every other kind.
    instructed : str
        The answer that an attention check asks for, as a number; empty for every other kind.
    seconds : float
        Time from the trial's start to its answer, in seconds.
    watched : float
        Share of the two videos that was really watched, in [0, 1].
    answered_at : datetime
        When the answer was stored, with its time zone.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    study_session: Name
    comparison: Name
    reference: Name
    other: Name
    segment: Name
    emotion: str
    speaker: str
    kind: Literal["practice", "main", "repeat", "catch", "attention"]
    position: Annotated[int, Field(ge=1)]
    question: Name
    left_condition: Name
    right_condition: Name
    value: Annotated[int, Field(ge=-2, le=2)]
    expected: Literal["left", "right", ""]
    seconds: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    watched: Annotated[float, Field(ge=0, le=1)]
    answered_at: AwareDatetime
    instructed: Annotated[str, Field(pattern="^(-?[12]|0)?$")] = ""

    @model_validator(mode="after")
    def _sides_fit_the_conditions(self) -> Self:
        if (self.kind == "attention") != bool(self.instructed):
            raise ValueError("instructed is for attention checks, and for all of them")
        shown = {self.left_condition, self.right_condition}
        if self.kind != "catch":
            if shown != {self.reference, self.other} or len(shown) != 2:
                raise ValueError(
                    "left_condition and right_condition are not the reference and the other"
                )
            if self.expected:
                raise ValueError("expected is only for catch trials")
            return self
        if len(shown) != 2 or self.other not in shown:
            raise ValueError("a catch trial shows two conditions, one of them 'other'")
        if self.expected != ("right" if self.left_condition == self.other else "left"):
            raise ValueError("expected is not the side opposite the catch condition")
        return self


COLUMNS: Final = tuple(Response.model_fields)

REQUIRED_COLUMNS: Final = tuple(
    name for name, column in Response.model_fields.items() if column.is_required()
)
"""What a file must have; the other columns are empty where it does not."""


def read_responses(path: Path) -> pd.DataFrame:
    """Read and check a CSV file of responses.

    Parameters
    ----------
    path : Path
        UTF-8 CSV with a header line that holds at least `REQUIRED_COLUMNS`; columns that
        are not among `COLUMNS` are ignored.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, one row per answer, in the file's order.

    Raises
    ------
    InputError
        If a column is missing, a value is not what `Response` states, or an answer occurs twice;
        it names the file, the line and the column.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            reader = csv.DictReader(stream)
            header = reader.fieldnames or ()
            missing = [name for name in REQUIRED_COLUMNS if name not in header]
            if missing:
                raise InputError(
                    f"column {', '.join(missing)} is missing",
                    where=f"{path}, line 1",
                    remedy="Export the responses again with 'motionjury export'",
                )
            numbered = [(reader.line_num, row) for row in reader]
    except FileNotFoundError:
        raise InputError(
            "there is no such file", where=path, remedy="Run 'motionjury export' first"
        ) from None
    except OSError as error:
        raise InputError(
            f"the file cannot be read: {error.strerror}", where=path, remedy="Check the path"
        ) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"this is not a CSV file in UTF-8: {error}",
            where=path,
            remedy="Save the table as CSV in UTF-8",
        ) from error
    return _frame([row for _, row in numbered], [f"{path}, line {line}" for line, _ in numbered])


def responses_frame(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Check answers that are already in memory and return them as a tidy table.

    Parameters
    ----------
    rows : sequence of mappings
        One mapping of column to value per answer; may be empty.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, in the order of `rows`.

    Raises
    ------
    InputError
        As `read_responses`, naming the row's place in `rows`.
    """
    return _frame(rows, [f"response {number}" for number, _ in enumerate(rows, start=1)])


def _frame(rows: Sequence[Mapping[str, Any]], places: Sequence[str]) -> pd.DataFrame:
    answers: list[Response] = []
    first: dict[tuple[str, int, str], str] = {}
    for row, place in zip(rows, places, strict=True):
        try:
            answer = Response.model_validate(row)
        except ValidationError as error:
            raise _input_error(error, place) from None
        key = (answer.study_session, answer.position, answer.question)
        if key in first:
            raise InputError(
                f"study session {key[0]} answers question {key[2]} of trial {key[1]} twice",
                where=place,
                remedy=f"Keep one of the two answers; the other is at {first[key]}",
            )
        first[key] = place
        answers.append(answer)
    records = [answer.model_dump(mode="json") for answer in answers]
    kinds = {"position": "int64", "value": "int64", "seconds": "float64", "watched": "float64"}
    frame = pd.DataFrame.from_records(records, columns=list(COLUMNS))
    return frame.astype({name: kinds.get(name, "str") for name in COLUMNS})


def _input_error(error: ValidationError, place: str) -> InputError:
    first = error.errors(include_url=False)[0]
    column = str(first["loc"][0]) if first["loc"] else ""
    found = f", found {first['input']!r}" if column else ""
    message = str(first["msg"]).removeprefix("Value error, ")
    return InputError(
        f"{message[0].lower()}{message[1:]}{found}",
        where=f"{place}, column {column}" if column else place,
        remedy="Correct the row or export the responses again",
    )
