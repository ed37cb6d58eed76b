"""Questions of a study: about its trials, and about the participant."""

import re
from collections.abc import Iterator, Sequence
from typing import Final, Literal, Self, get_args

from pydantic import Field, model_validator

from motion.errors import listed
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.sections import Name, Section

TRIAL_FIELD: Final = "trial"
"""The page's own form field."""

_OF_FACES: Final = re.compile(
    r"\b(faces?|facial|lips?|mouth)\b|gesicht(?!spunkt)|mimik|lippen|顔|表情", re.IGNORECASE
)
_IGNORED: Final = re.compile(
    r"\b(ignor|disregard)\w* (the )?\w+((,|,? and|,? or) (the )?\w+)*", re.IGNORECASE
)


def is_about_face(text: str) -> bool:
    """Tell whether the text of a question names the face, other than to ignore it."""
    return _OF_FACES.search(_IGNORED.sub("", text)) is not None


class Reason(Section):
    """One reason that participants may tick with their answer."""

    name: Name
    text: str = Field(min_length=1, max_length=200)


class Question(Section):
    """One question of a trial; ``{emotion}`` in the text becomes the segment's emotion.

    Attributes
    ----------
    parts : tuple of str
        The parts of the study that ask it; empty for all.
    reasons : tuple of Reason
        Optional check boxes.
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
            raise ValueError("the text may contain {emotion} but no other braces")
        if len(set(self.reason_names)) != len(self.reasons):
            raise ValueError("two reasons have the same name")
        return self

    @property
    def reason_names(self) -> tuple[str, ...]:
        """The names under which reasons are stored."""
        return tuple(reason.name for reason in self.reasons)

    def belongs_to(self, part: str) -> bool:
        """Tell whether trials in `part` ask it."""
        return not self.parts or part in self.parts


def question_problems(questions: Sequence[Question], parts: Sequence[str]) -> list[str]:
    """Return what is wrong with `questions` in a study with these `parts`."""
    problems = []
    names = [question.name for question in questions]
    if len(set(names)) != len(names):
        problems.append("two questions have the same name")
    if TRIAL_FIELD in names:
        problems.append(f"no question can be named {TRIAL_FIELD!r}: the page uses that name itself")
    for question in questions:
        unknown = [part for part in question.parts if part not in parts]
        if unknown:
            known = f"use {', '.join(parts)}" if parts else "the study has no parts"
            problems.append(f"question {question.name!r}: unknown part {unknown[0]!r} ({known})")
    for part in parts:
        if not any(question.belongs_to(part) for question in questions):
            problems.append(f"part {part!r} has no questions")
    return problems


SCALE_STEPS: Final = 5

QUALITY_CATEGORIES: Final = ("bad", "poor", "fair", "good", "excellent")
"""The categories of absolute category rating (ITU-T P.910), from the worst."""

SLIDER_MAX: Final = 100
BAND_WIDTH: Final = SLIDER_MAX // SCALE_STEPS


class RatingQuestion(Question):
    """A question about each stimulus of a trial.

    Attributes
    ----------
    scale : {'labels', 'slider', 'mean_opinion'}
        Five labels of the study's own; a slider from 0 to 100 without a default, in five labelled
        bands (HEMVIP, Jonell et al. 2021); or the five categories of ITU-T P.910.
    labels : tuple of str
        The five labels, from the worst to the best.
    """

    scale: Literal["labels", "slider", "mean_opinion"] = "labels"
    labels: tuple[str, ...] = Field(QUALITY_CATEGORIES, strict=False)

    @model_validator(mode="after")
    def _has_labels(self) -> Self:
        has_labels = "labels" in self.model_fields_set
        if self.scale == "labels" and not has_labels:
            raise ValueError("give five labels, from the worst to the best")
        if self.scale == "mean_opinion" and has_labels:
            raise ValueError(
                'mean_opinion has its own labels: leave labels out, or use scale = "labels"'
            )
        if len(set(self.labels)) != SCALE_STEPS:
            raise ValueError("give five different labels, from the worst to the best")
        return self

    @property
    def values(self) -> Sequence[int]:
        """The possible answers, from the worst."""
        return range(SLIDER_MAX + 1) if self.scale == "slider" else range(1, SCALE_STEPS + 1)

    def step(self, value: int) -> int:
        """Return the number of the label of `value`, from 1."""
        return min(value // BAND_WIDTH + 1, SCALE_STEPS) if self.scale == "slider" else value


Stage = Literal["eligibility", "consent", "demographics", "comprehension", "closing"]

STAGES: Final[tuple[Stage, ...]] = get_args(Stage)
"""In the order of a study session: `comprehension` is asked below the instructions, `closing` after
the trials."""

SCREENING_STAGES: Final[tuple[Stage, ...]] = ("eligibility", "consent", "comprehension")
"""The stages whose answers decide who can take part."""

MAX_TEXT_LENGTH: Final = 2000
MAX_CHOICES: Final = 40


class FormQuestion(Section):
    """One question about the participant.

    Attributes
    ----------
    kind : {'text', 'choice', 'number', 'scale'}
        Free text, one of `choices`, a number from `low` to `high`, or a step of a scale from `low`
        to `high` with `choices` as its end labels.
    required : bool
        Whether it must be answered.
    eligible : tuple of str
        Under `eligibility` and `consent`: the choices of those who can take part; empty for all.
        Under `comprehension`: the right choices.
    """

    name: Name
    text: str = Field(min_length=1, max_length=1000)
    kind: Literal["text", "choice", "number", "scale"] = "choice"
    choices: tuple[str, ...] = Field((), max_length=MAX_CHOICES, strict=False)
    low: int = 0
    high: int = 120
    required: bool = True
    eligible: tuple[str, ...] = Field((), strict=False)

    @model_validator(mode="after")
    def _is_usable(self) -> Self:
        if self.kind == "choice" and len(self.choices) < 1:
            raise ValueError("a question of kind 'choice' needs choices")
        if self.kind == "scale" and len(self.choices) not in (0, 2):
            raise ValueError("a scale has no choices, or two: the labels of its ends")
        if self.kind in ("text", "number") and self.choices:
            raise ValueError(f"a question of kind {self.kind!r} cannot have choices")
        if self.low >= self.high:
            raise ValueError(f"low ({self.low}) must be below high ({self.high})")
        if len({choice.strip() for choice in self.choices} - {""}) < len(self.choices):
            raise ValueError("all choices must be different, and none may be empty")
        if self.kind == "scale" and self.high - self.low >= MAX_CHOICES:
            raise ValueError(
                f"a scale from {self.low} to {self.high} has more than {MAX_CHOICES} steps: set "
                "low and high, or ask for a number"
            )
        if not set(self.eligible) <= set(self.choices if self.kind == "choice" else ()):
            raise ValueError("eligible may only name choices of the question")
        return self

    @property
    def offered(self) -> tuple[str, ...]:
        """The possible answers of a choice or a scale, in order."""
        if self.kind == "scale":
            return tuple(str(step) for step in range(self.low, self.high + 1))
        return self.choices

    @property
    def example(self) -> str:
        """An answer that lets a person take part."""
        if self.kind == "text":
            return "–"
        if self.kind == "number":
            return str(self.low)
        return (self.eligible or self.offered)[0]

    def label(self, answer: str) -> str:
        """Return the label of one of the answers `offered`."""
        if self.kind == "scale" and self.choices:
            ends = {str(self.low): self.choices[0], str(self.high): self.choices[1]}
            return f"{answer} – {ends[answer]}" if answer in ends else answer
        return answer

    def problem(self, answer: str, number: int = 1) -> Message | None:
        """Say why `answer` to question `number` cannot be accepted; None if it can."""
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
            is_integer = re.fullmatch(r"-?[0-9]{1,9}", answer) is not None
            if is_integer and self.low <= int(answer) <= self.high:
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


class Form(Section):
    """All questions about the participant, by stage."""

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
            raise ValueError(f"eligible is only allowed under {listed(SCREENING_STAGES)}")
        for question in self.comprehension:
            right, wrong = set(question.eligible), set(question.choices) - set(question.eligible)
            if not (question.required and right and wrong):
                raise ValueError(
                    f"the comprehension question {question.name!r} must be required, and eligible "
                    "must name its right choices, but not all choices"
                )
        return self

    def questions_at(self, stage: Stage) -> tuple[FormQuestion, ...]:
        """Return the questions of one stage."""
        questions: tuple[FormQuestion, ...] = getattr(self, stage)
        return questions

    def asked(self) -> Iterator[tuple[Stage, FormQuestion]]:
        """Yield all questions, each with its stage."""
        return ((stage, question) for stage in STAGES for question in self.questions_at(stage))
