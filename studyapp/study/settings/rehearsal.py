"""`[rehearsal]`: whom `motionjury rehearse` lets take part, and what they really prefer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Self

from pydantic import BeforeValidator, Field, model_validator

from studyapp.study.settings.sections import Name, Section

EVERY_QUESTION: Final = "*"
"""Stands for all questions that are not named."""

Share = Annotated[float, Field(ge=0, le=1, strict=False)]
Logits = Annotated[float, Field(ge=-20, le=20, allow_inf_nan=False, strict=False)]


def _by_question(stated: Any) -> Any:
    """Take a number alone for that of every question."""
    if isinstance(stated, int | float) and not isinstance(stated, bool):
        return {EVERY_QUESTION: stated}
    if not isinstance(stated, dict):
        raise ValueError("must be a number, or a table with a number for each question")
    return stated


Strengths = dict[Name, Annotated[dict[str, Logits], BeforeValidator(_by_question)]]
"""By condition, logits for each question; `EVERY_QUESTION` for those that are not named."""

SHARES: Final = (
    *("hasty", "side_biased", "straight_lining", "careless"),
    *("dropping_out", "returning", "double_clicking"),
)
"""Keys that are shares of the participants; whoever is left over is attentive."""


class Rehearsal(Section):
    """Whom a rehearsal simulates. It decides nothing about the study itself.

    Attributes
    ----------
    hasty : float
        Share of participants who watch as little as they may, answer at once and see little.
    side_biased : float
        Share of those who are drawn to one side, or to the first or last of several videos.
    straight_lining : float
        Share of those who always give the same answer to a question.
    careless : float
        Share of those who answer everything at random.
    dropping_out : float
        Share of those who leave somewhere between the first and the last trial, for good.
    returning : float
        Share of those who leave likewise, and come back later.
    double_clicking : float
        Share of those who press every button twice, and the study's link once more.
    participants_differ, segments_differ : float
        Standard deviations of the difference between two conditions, over participants and over
        segments, in logits.
    strength : mapping of condition to number, or of condition and question to number
        How good a condition is, in logits; whoever is not named is as good as rehearsals take
        its name or its generator for.
    own_speech : mapping likewise
        By how many logits a condition's motion suits its own speech better than another's.
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
    def _leaves_no_negative_share(self) -> Self:
        total = sum(self.shares.values())
        if total > 1 + 1e-9:
            raise ValueError(
                f"the shares {', '.join(SHARES)} add up to {total:.4g}, which is more than 1"
            )
        return self

    @property
    def shares(self) -> dict[str, float]:
        """The share of each kind that is not plainly attentive."""
        return {name: getattr(self, name) for name in SHARES}

    def problems(self, conditions: Sequence[str], questions: Sequence[str]) -> list[str]:
        """Return what names no condition or question of the study."""
        return [
            *_unknown("strength", self.strength, conditions, questions),
            *_unknown("own_speech", self.own_speech, conditions, questions),
        ]


def stated_strength(
    strengths: Mapping[str, Mapping[str, float]], condition: str, question: str
) -> float | None:
    """Return what is stated of a condition and a question; None where nothing is."""
    own = strengths.get(condition, {})
    return own.get(question, own.get(EVERY_QUESTION))


def _unknown(
    key: str,
    strengths: Mapping[str, Mapping[str, float]],
    conditions: Sequence[str],
    questions: Sequence[str],
) -> list[str]:
    known = (*questions, EVERY_QUESTION)
    return [
        *(
            f"rehearsal.{key}: unknown condition {name!r} (use {', '.join(conditions)})"
            for name in strengths
            if name not in conditions
        ),
        *(
            f"rehearsal.{key}.{name}: unknown question {question!r} (use {', '.join(questions)})"
            for name, own in strengths.items()
            for question in own
            if question not in known
        ),
    ]
