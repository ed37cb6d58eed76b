"""Questions about the participant: eligibility, consent, demographics and closing questions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final, Literal, Self

from pydantic import Field, model_validator

from studyapp.study.design.message import Message
from studyapp.study.settings.section import Name, Section

Stage = Literal["eligibility", "consent", "demographics", "closing"]

STAGES: Final[tuple[Stage, ...]] = ("eligibility", "consent", "demographics", "closing")
"""In the order in which they are asked; the trials come before `closing`."""

LONGEST_TEXT: Final = 2000


class FormQuestion(Section):
    """One question about the participant.

    Attributes
    ----------
    kind : {'text', 'choice', 'number', 'scale'}
        Something to write, one of `choices`, a number from `low` to `high`, or a step of a scale
        from `low` to `high` with `choices` at its two ends.
    choices : tuple of str
        See `kind`.
    low, high : int
        See `kind`.
    required : bool
        Whether it must be answered.
    eligible : tuple of str
        Under `eligibility` and `consent`: with any other choice a person cannot take part.
        Empty where every answer will do.
    """

    name: Name
    text: str = Field(min_length=1, max_length=1000)
    kind: Literal["text", "choice", "number", "scale"] = "choice"
    choices: tuple[str, ...] = Field((), max_length=40, strict=False)
    low: int = 0
    high: int = 120
    required: bool = True
    eligible: tuple[str, ...] = Field((), strict=False)

    @model_validator(mode="after")
    def _is_usable(self) -> Self:
        if self.kind == "choice" and len(self.choices) < 1:
            raise ValueError("a choice needs choices")
        if self.kind == "scale" and len(self.choices) not in (0, 2):
            raise ValueError("a scale has no choices, or two: the words at its ends")
        if self.kind in ("text", "number") and self.choices:
            raise ValueError(f"a {self.kind} has no choices")
        if self.low >= self.high:
            raise ValueError(f"low {self.low} is not below high {self.high}")
        if not set(self.eligible) <= set(self.choices if self.kind == "choice" else ()):
            raise ValueError("eligible names something that is not among the choices")
        return self

    @property
    def offered(self) -> tuple[str, ...]:
        """The answers of a choice or a scale, in their order."""
        if self.kind == "scale":
            return tuple(str(step) for step in range(self.low, self.high + 1))
        return self.choices

    @property
    def example(self) -> str:
        """An answer with which a person can take part."""
        if self.kind == "text":
            return "–"
        if self.kind == "number":
            return str(self.low)
        return (self.eligible or self.offered)[0]

    def label(self, answer: str) -> str:
        """Return what stands beside one of the answers `offered`."""
        if self.kind == "scale" and self.choices:
            words = {str(self.low): self.choices[0], str(self.high): self.choices[1]}
            return f"{answer} – {words[answer]}" if answer in words else answer
        return answer

    def problem(self, answer: str, number: int = 1) -> Message | None:
        """Say why `answer` cannot be accepted as that to question `number`; None where it can."""
        if not answer.strip():
            missing = Message("Question {number} is not answered yet.", number=number)
            return missing if self.required else None
        if self.kind == "text":
            if len(answer) <= LONGEST_TEXT:
                return None
            return Message(
                "The answer to question {number} is longer than {most} characters.",
                number=number,
                most=LONGEST_TEXT,
            )
        if self.kind == "number":
            if _is_whole(answer) and self.low <= int(answer) <= self.high:
                return None
            return Message(
                "Question {number} needs a whole number from {low} to {high}.",
                number=number,
                low=self.low,
                high=self.high,
            )
        if answer in self.offered:
            return None
        return Message(
            "Question {number} has an answer that is not one of those offered.", number=number
        )


def _is_whole(answer: str) -> bool:
    return re.fullmatch(r"-?[0-9]{1,9}", answer) is not None


class Form(Section):
    """All questions about the participant, by when they are asked."""

    eligibility: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    consent: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    demographics: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    closing: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)

    @model_validator(mode="after")
    def _is_usable(self) -> Self:
        names = [question.name for stage in STAGES for question in self.asked(stage)]
        if len(set(names)) != len(names):
            raise ValueError("two questions of the form have the same name")
        if any(q.eligible for stage in STAGES[2:] for q in self.asked(stage)):
            raise ValueError("eligible can only be stated under eligibility and consent")
        return self

    def asked(self, stage: Stage) -> tuple[FormQuestion, ...]:
        """Return the questions of one stage."""
        asked: tuple[FormQuestion, ...] = getattr(self, stage)
        return asked

    def stages(self) -> Iterator[Stage]:
        """Yield the stages at which something is asked."""
        return (stage for stage in STAGES if self.asked(stage))
