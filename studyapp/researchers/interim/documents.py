"""What the process that computes hands over, and pages show: plain data, checked on the way."""

from __future__ import annotations

from typing import Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from studyapp.researchers.looks import StudyState

FORMAT: Final = 1
"""Of the documents; to be raised where they change, so that older ones are computed anew."""

What = Literal["agreement", "results"]


class _Plain(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Number(_Plain):
    """A number with its 95 % interval; None where there is none, and then `reason` says why."""

    estimate: float | None
    low: float | None
    high: float | None
    reason: str


class Agreed(_Plain):
    """How far participants agree about one question.

    Attributes
    ----------
    task, set : str
        The protocol that the question is analysed by, and the set; empty where there is one.
    measure : {'alpha', 'w'}
        Krippendorff's alpha, or Kendall's W.
    agreement : Number
        With one another.
    answers, participants : int
        What it rests on.
    retest : Number or None
        With themselves, as Cohen's weighted kappa; None where nothing is asked twice.
    repeated : int
        Trials that were answered twice.
    """

    task: str
    set: str
    question: str
    measure: Literal["alpha", "w"]
    agreement: Number
    answers: int
    participants: int
    retest: Number | None
    repeated: int


class Estimated(_Plain):
    """One headline number; see `analysis.results.headline.HeadlineNumber`."""

    task: str
    set: str
    question: str
    about: str
    against: str
    measure: Literal["win_share", "own_speech", "mean_rating", "mean_rank"]
    number: Number
    answers: int
    participants: int
    segments: int


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


class _Document(_Plain):
    @classmethod
    def read(cls, text: str) -> Self | None:
        """Return what was kept; None where nothing was, or by another version."""
        try:
            return cls.model_validate_json(text)
        except ValidationError:
            return None


class AgreementDocument(_Document):
    """Agreement so far, question by question."""

    basis: Basis
    rows: tuple[Agreed, ...] = Field(max_length=1000)


class ResultsDocument(_Document):
    """Results so far, number by number."""

    basis: Basis
    rows: tuple[Estimated, ...] = Field(max_length=10_000)
