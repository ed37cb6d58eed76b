"""`[rehearsal]`: the simulated participants of `motionjury rehearse`, and their preferences."""

from collections.abc import Sequence
from typing import Annotated, Any, Final, Self

from pydantic import BeforeValidator, Field, model_validator

from studyapp.study.settings.sections import Name, Section

EVERY_QUESTION: Final = "*"
"""Stands for all questions not listed."""

Share = Annotated[float, Field(ge=0, le=1, strict=False)]
Logits = Annotated[float, Field(ge=-20, le=20, strict=False)]


def _by_question(value: Any) -> Any:
    """Return a single number as that of every question."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return {EVERY_QUESTION: value}
    if not isinstance(value, dict):
        raise ValueError("must be a number, or a table with a number for each question")
    return value


Strengths = dict[Name, Annotated[dict[str, Logits], BeforeValidator(_by_question)]]
"""Logits by condition and question."""

SHARES: Final = (
    *("hasty", "side_biased", "straight_lining", "careless"),
    *("dropping_out", "returning", "double_clicking"),
)
"""Shares of participants; all others are attentive."""


class Rehearsal(Section):
    """The simulated participants; nothing about the study itself.

    Attributes
    ----------
    hasty : float
        Share of participants who watch the required minimum, answer at once and see little.
    side_biased : float
        Share of those who favour one side, or the first or last of several videos.
    straight_lining : float
        Share of those who always give the same answer to a question.
    careless : float
        Share of those who answer at random.
    dropping_out : float
        Share of those who leave between the first and the last trial, for good.
    returning : float
        Share of those who leave and come back later.
    double_clicking : float
        Share of those who click every button twice, and open the study's link again.
    participants_differ, segments_differ : float
        Standard deviations of the difference between two conditions over participants and over
        segments, in logits.
    strength : mapping of condition to number, or of condition and question to number
        How good a condition is, in logits; by default, a guess from its name or generator.
    own_speech : mapping, like `strength`
        How much better a condition's motion fits its own speech than another's, in logits.
    """

    hasty: Share = 0.04
    side_biased: Share = 0.03
    straight_lining: Share = 0.03
    careless: Share = 0.08
    dropping_out: Share = 0.06
    returning: Share = 0.05
    double_clicking: Share = 0.05
    participants_differ: float = Field(0.6, ge=0, le=10, strict=False)
    segments_differ: float = Field(0.45, ge=0, le=10, strict=False)
    strength: Strengths = Field(default_factory=dict)
    own_speech: Strengths = Field(default_factory=dict)

    @model_validator(mode="after")
    def _shares_add_up(self) -> Self:
        total = sum(self.shares.values())
        if total > 1 + 1e-9:
            raise ValueError(
                f"the shares {', '.join(SHARES)} add up to {total:.4g}, which is more than 1"
            )
        return self

    @property
    def shares(self) -> dict[str, float]:
        """The share of each kind of participant that is not attentive."""
        return {name: getattr(self, name) for name in SHARES}

    def problems(self, conditions: Sequence[str], questions: Sequence[str]) -> list[str]:
        """Return the unknown conditions and questions."""
        problems = []
        for key, strengths in (("strength", self.strength), ("own_speech", self.own_speech)):
            for name, by_question in strengths.items():
                if name not in conditions:
                    known = ", ".join(conditions)
                    problems.append(f"rehearsal.{key}: unknown condition {name!r} (use {known})")
                problems += [
                    f"rehearsal.{key}.{name}: unknown question {question!r} "
                    f"(use {', '.join(questions)})"
                    for question in by_question
                    if question not in (*questions, EVERY_QUESTION)
                ]
        return problems
