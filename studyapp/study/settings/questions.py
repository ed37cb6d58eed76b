"""Questions of a trial, and the reasons that may be ticked beside an answer."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Self

from pydantic import Field, model_validator

from studyapp.study.settings.section import Name, Section

RESERVED_NAMES = ("trial",)
"""Names of the page's own fields."""


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
