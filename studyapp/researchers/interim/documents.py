"""What the process that computes hands over, and pages show: plain data."""

from __future__ import annotations

from typing import Any, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from studyapp.researchers.looks import StudyState

FORMAT: Final = 2
"""Of the documents; to be raised where they change, so that older ones are computed anew."""

What = Literal["agreement", "results"]


class _Plain(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Basis(_Plain):
    """What figures rest on.

    Attributes
    ----------
    finished, planned, answers : int
        How far the study was; see `StudyState`.
    answered, analysed : int
        Participants who gave an answer that counts, and those whom no rule leaves out.
    """

    finished: int
    planned: int
    answers: int
    answered: int
    analysed: int

    @property
    def state(self) -> StudyState:
        """The same, for the log."""
        return StudyState(finished=self.finished, planned=self.planned, answers=self.answers)


class Document(_Plain):
    """Agreement or results so far.

    Attributes
    ----------
    rows : tuple of dict
        Plain data of `analysis.results.headline.AgreedSoFar`, question by question, or of
        `HeadlineNumber`, number by number; each with the `task` that it is analysed by, and
        with an empty `set` where there is one.
    """

    format: Literal[2] = FORMAT
    basis: Basis
    rows: tuple[dict[str, Any], ...] = Field(max_length=10_000)

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Return what was kept; None where nothing was, or by another version."""
        try:
            return cls.model_validate_json(text)
        except ValidationError:
            return None
