"""What a trial asks for, and what may be answered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

AnswerKey = tuple[str, int | None]
"""A question, and the number of the stimulus it is answered for: None for the whole trial."""

Answers = Mapping[AnswerKey, int]


@dataclass(frozen=True, kw_only=True)
class Ask:
    """One answer that a trial asks for.

    Attributes
    ----------
    question : str
        Name of the question.
    stimulus : int or None
        Number of the stimulus it is about, from 1; None where it is about the whole trial.
    values : sequence of int
        What may be answered.
    reasons : tuple of str
        Names of the reasons that may be ticked beside the answer.
    shares_reasons : bool
        Whether they are ticked once for all answers to the question, as beside an order.
    """

    question: str
    stimulus: int | None = None
    values: Sequence[int]
    reasons: tuple[str, ...] = ()
    shares_reasons: bool = False

    @property
    def key(self) -> AnswerKey:
        """What the answer is stored under."""
        return self.question, self.stimulus

    @property
    def field(self) -> str:
        """Name of the form's field; no question's name holds a colon."""
        return self.question if self.stimulus is None else f"{self.question}:{self.stimulus}"

    @property
    def reasons_field(self) -> str:
        """Name of the check boxes with reasons."""
        return f"{self.question if self.shares_reasons else self.field}:reasons"


class Trial(Protocol):
    """What must be known of a trial to judge its answers, planned or stored alike."""

    @property
    def kind(self) -> str:
        """Its kind."""

    @property
    def part(self) -> str:
        """The part of the study it belongs to."""

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""

    @property
    def expected(self) -> int | None:
        """Of a catch trial: the number of the plainly better stimulus."""

    @property
    def instructed(self) -> int | None:
        """Of an attention check: the value that the page asks to choose."""
