"""Questions of a study: of its trials with their scales and reasons, and of the participant."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final, Literal, Self, get_args

from pydantic import Field, model_validator

from motion.errors import listed
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.sections import Name, Section

RESERVED_NAMES = ("trial",)
"""Names of the page's own fields."""

_OF_FACES: Final = re.compile(
    r"\b(faces?|facial|lips?|mouth)\b|gesicht|mimik|lippen|顔|表情", re.IGNORECASE
)


def is_about_face(text: str) -> bool:
    """Tell whether the text of a question names the face."""
    return _OF_FACES.search(text) is not None


class Reason(Section):
    """One reason that participants may tick beside their answer."""

    name: Name
    text: str = Field(min_length=1, max_length=200)


class Question(Section):
    """One question of a trial; ``{emotion}`` in the text becomes the segment's emotion.

    Attributes
    ----------
    parts : tuple of str
        The parts of the study that ask it; empty for all of them.
    reasons : tuple of Reason
        Check boxes beside the answer; they may all stay empty.
    """

    name: Name
    title: str = Field(min_length=1, max_length=60)
    text: str = Field(min_length=1, max_length=300)
    parts: tuple[Name, ...] = Field((), strict=False)
    reasons: tuple[Reason, ...] = Field((), max_length=20, strict=False)

    @model_validator(mode="after")
    def _is_usable(self) -> Self:
        unknown = set(re.findall(r"{(.*?)}", self.text)) - {"emotion"}
        if unknown or self.text.count("{") != self.text.count("}"):
            raise ValueError("the text may hold {emotion} and no other braces")
        if len(set(self.reason_names)) != len(self.reasons):
            raise ValueError("two reasons have the same name")
        return self

    @property
    def reason_names(self) -> tuple[str, ...]:
        """The names under which reasons are stored."""
        return tuple(reason.name for reason in self.reasons)

    def belongs_to(self, part: str) -> bool:
        """Tell whether trials of `part` ask it."""
        return not self.parts or part in self.parts


def question_problems(questions: Sequence[Question], parts: Sequence[str]) -> list[str]:
    """Return what is wrong with `questions` of a study with these `parts`."""
    problems = []
    names = [question.name for question in questions]
    if len(set(names)) != len(names):
        problems.append("two questions have the same name")
    for name in RESERVED_NAMES:
        if name in names:
            problems.append(f"no question can be named {name!r}, the page sends its own field so")
    for question in questions:
        unknown = [part for part in question.parts if part not in parts]
        if unknown:
            known = f"use {', '.join(parts)}" if parts else "the study has no parts"
            problems.append(f"question {question.name!r}: unknown part {unknown[0]!r} ({known})")
    for part in parts:
        if not any(question.belongs_to(part) for question in questions):
            problems.append(f"no question is asked in {part!r}")
    return problems


SCALE_STEPS: Final = 5

QUALITY_CATEGORIES: Final = ("bad", "poor", "fair", "good", "excellent")
"""The five categories of absolute category rating, from the worst (ITU-T P.910)."""

SLIDER_MAX: Final = 100
BAND_WIDTH: Final = SLIDER_MAX // SCALE_STEPS


class RatingQuestion(Question):
    """A question about each stimulus of a trial.

    Attributes
    ----------
    scale : {'labels', 'slider', 'mean_opinion'}
        Five labels of the study's own; a slider from 0 to 100 without a preset, in five labelled
        bands (HEMVIP, Jonell et al. 2021); or the five categories of ITU-T P.910.
    labels : tuple of str
        From the worst to the best: the labels, or the names of the slider's bands.
    """

    scale: Literal["labels", "slider", "mean_opinion"] = "labels"
    labels: tuple[str, ...] = Field(QUALITY_CATEGORIES, strict=False)

    @model_validator(mode="after")
    def _has_labels(self) -> Self:
        given = "labels" in self.model_fields_set
        if self.scale == "labels" and not given:
            raise ValueError("a scale of labels needs its five labels, from the worst to the best")
        if self.scale == "mean_opinion" and given:
            raise ValueError('mean_opinion has labels of its own; use scale = "labels"')
        if len(set(self.labels)) != SCALE_STEPS:
            raise ValueError("labels must be five different ones, from the worst to the best")
        return self

    @property
    def values(self) -> Sequence[int]:
        """What may be answered; 1 or 0 is the worst."""
        return range(SLIDER_MAX + 1) if self.scale == "slider" else range(1, SCALE_STEPS + 1)

    def step(self, value: int) -> int:
        """Return which of the five labels `value` falls under, from 1."""
        return min(value // BAND_WIDTH + 1, SCALE_STEPS) if self.scale == "slider" else value


Stage = Literal["eligibility", "consent", "demographics", "comprehension", "closing"]

STAGES: Final[tuple[Stage, ...]] = get_args(Stage)
"""In the order in which they are asked: `comprehension` under the instructions, `closing` after the
trials."""

SCREENING_STAGES: Final[tuple[Stage, ...]] = ("eligibility", "consent", "comprehension")
"""Those at which an answer decides who takes part."""

MAX_TEXT_LENGTH: Final = 2000


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
        Under `eligibility` and `consent`: with any other choice a person cannot take part; empty
        where every answer will do. Under `comprehension`: the right choices.
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
            if len(answer) <= MAX_TEXT_LENGTH:
                return None
            return Message(
                "The answer to question {number} is longer than {most} characters.",
                number=number,
                most=MAX_TEXT_LENGTH,
            )
        if self.kind == "number":
            if _is_integer(answer) and self.low <= int(answer) <= self.high:
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


def _is_integer(answer: str) -> bool:
    return re.fullmatch(r"-?[0-9]{1,9}", answer) is not None


class Form(Section):
    """All questions about the participant, by when they are asked."""

    eligibility: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    consent: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    demographics: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    comprehension: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)
    closing: tuple[FormQuestion, ...] = Field((), max_length=20, strict=False)

    @model_validator(mode="after")
    def _is_usable(self) -> Self:
        names = [question.name for stage in STAGES for question in self.questions_at(stage)]
        if len(set(names)) != len(names):
            raise ValueError("two questions of the form have the same name")
        others = (stage for stage in STAGES if stage not in SCREENING_STAGES)
        if any(question.eligible for stage in others for question in self.questions_at(stage)):
            raise ValueError(f"eligible can only be stated under {listed(SCREENING_STAGES)}")
        for question in self.comprehension:
            if not question.required or not question.eligible:
                raise ValueError(
                    f"comprehension question {question.name!r} needs choices, of which eligible "
                    "names the right ones, and an answer"
                )
            if set(question.eligible) == set(question.choices):
                raise ValueError(
                    f"comprehension question {question.name!r} has no choice that is wrong"
                )
        return self

    def questions_at(self, stage: Stage) -> tuple[FormQuestion, ...]:
        """Return the questions of one stage."""
        asked: tuple[FormQuestion, ...] = getattr(self, stage)
        return asked

    def stages(self) -> Iterator[Stage]:
        """Yield the stages at which something is asked."""
        return (stage for stage in STAGES if self.questions_at(stage))
