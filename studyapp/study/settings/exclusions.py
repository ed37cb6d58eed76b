"""The exclusion rules that a study file may state: who is left out of the analysis."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, Final, Literal

from pydantic import Field

from analysis.answers.exclusion_rules import (
    ExclusionRule,
    answered_too_fast,
    failed_attention_checks,
    failed_catch_trials,
    incomplete,
    straight_lined,
    watched_less,
)
from studyapp.study.settings.section import Section


class ExclusionSection(Section, ABC):
    """One rule, an entry of ``[[exclusions]]``.

    Attributes
    ----------
    rule : str
        Its name.
    limit : (str, str) or None
        How the rule is written in one word: its sign, and the key that the number behind it is
        for; None for a rule without a number.
    """

    limit: ClassVar[tuple[str, str] | None] = None

    rule: str

    @abstractmethod
    def made(self) -> ExclusionRule:
        """Return the rule."""

    def written(self) -> str:
        """Return the rule as one writes it in one word, such as ``catch>1``."""
        settings = self.model_dump(exclude={"rule"})
        word = self.rule
        if self.limit is not None:
            sign, key = self.limit
            word += f"{sign}{settings.pop(key):g}"
        return ",".join([word, *(f"{key}={value:g}" for key, value in settings.items())])


class Incomplete(ExclusionSection):
    """Who did not get through all trials."""

    rule: Literal["incomplete"] = "incomplete"

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return incomplete()


class FailedCatch(ExclusionSection):
    """Who failed too many catch trials.

    Attributes
    ----------
    more_than : int
        More failed catch trials than this exclude; where it is not written, `Catch.max_failed`.
    """

    limit: ClassVar = (">", "more_than")

    rule: Literal["catch"] = "catch"
    more_than: int = Field(1, ge=0, le=20)

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return failed_catch_trials(self.more_than)


class FailedAttention(ExclusionSection):
    """Who failed too many attention checks.

    Attributes
    ----------
    more_than : int
        More failed checks than this exclude; where it is not written, `Attention.max_failed`.
    """

    limit: ClassVar = (">", "more_than")

    rule: Literal["attention"] = "attention"
    more_than: int = Field(1, ge=0, le=10)

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return failed_attention_checks(self.more_than)


class Coverage(ExclusionSection):
    """Who watched too little of the videos.

    Attributes
    ----------
    below : float
        A smaller mean share of the videos of analysed trials excludes.
    """

    limit: ClassVar = ("<", "below")

    rule: Literal["coverage"] = "coverage"
    below: float = Field(gt=0, le=1)

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return watched_less(self.below)


class Time(ExclusionSection):
    """Who answered too fast.

    Attributes
    ----------
    below : float
        Seconds from the first showing of a trial to its answer below which it is too fast.
    share : float
        Share of too fast answers from which a participant is excluded; one half makes it a rule
        about the median.
    """

    limit: ClassVar = ("<", "below")

    rule: Literal["time"] = "time"
    below: float = Field(gt=0, le=3600)
    share: float = Field(0.5, gt=0, le=1)

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return answered_too_fast(self.below, self.share)


class StraightLining(ExclusionSection):
    """Who gave the same answer to a question again and again.

    Attributes
    ----------
    at_least : float
        Share of the most frequent answer to a question from which a participant is excluded.
    trials : int
        Questions answered less often by a participant are not looked at.
    """

    limit: ClassVar = (">=", "at_least")

    rule: Literal["straight_lining"] = "straight_lining"
    at_least: float = Field(gt=0.5, le=1)
    trials: int = Field(10, ge=2, le=1000)

    def made(self) -> ExclusionRule:
        """Return the rule."""
        return straight_lined(self.at_least, self.trials)


SECTIONS: Final[tuple[type[ExclusionSection], ...]] = (
    *(Incomplete, FailedCatch, FailedAttention, Coverage, Time, StraightLining),
)
"""All of them."""

Exclusion = Annotated[
    Incomplete | FailedCatch | FailedAttention | Coverage | Time | StraightLining,
    Field(discriminator="rule"),
]
"""An entry of ``[[exclusions]]``."""
