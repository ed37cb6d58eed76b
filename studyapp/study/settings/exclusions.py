"""The exclusion rules that a study file may state: who is left out of the analysis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
from motion.errors import listed
from studyapp.study.settings.conditions import Attention, Catch
from studyapp.study.settings.sections import Section


class ExclusionSection(Section):
    """One rule, an entry of ``[[exclusions]]``.

    Attributes
    ----------
    rule : str
        Its name.
    limit : (str, str) or None
        How the rule is written in one word: its sign, and the key that the number behind it is
        for; None for a rule without a number.
    maker : callable
        Makes the rule of the section's other keys, in their order.
    """

    limit: ClassVar[tuple[str, str] | None] = None
    maker: ClassVar[Callable[..., ExclusionRule]]

    rule: str

    def to_rule(self) -> ExclusionRule:
        """Return the rule."""
        return type(self).maker(*self.model_dump(exclude={"rule"}).values())

    def shorthand(self) -> str:
        """Return the rule as one writes it in one word, such as ``catch>1``."""
        settings = self.model_dump(exclude={"rule"})
        word = self.rule
        if self.limit is not None:
            sign, key = self.limit
            word += f"{sign}{settings.pop(key):g}"
        return ",".join([word, *(f"{key}={value:g}" for key, value in settings.items())])


class Incomplete(ExclusionSection):
    """Who did not get through all trials."""

    maker: ClassVar = incomplete

    rule: Literal["incomplete"] = "incomplete"


class FailedCatch(ExclusionSection):
    """Who failed too many catch trials.

    Attributes
    ----------
    more_than : int
        More failed catch trials than this exclude; where it is not written, `Catch.max_failed`.
    """

    limit: ClassVar = (">", "more_than")
    maker: ClassVar = failed_catch_trials

    rule: Literal["catch"] = "catch"
    more_than: int = Field(1, ge=0, le=20)


class FailedAttention(ExclusionSection):
    """Who failed too many attention checks.

    Attributes
    ----------
    more_than : int
        More failed checks than this exclude; where it is not written, `Attention.max_failed`.
    """

    limit: ClassVar = (">", "more_than")
    maker: ClassVar = failed_attention_checks

    rule: Literal["attention"] = "attention"
    more_than: int = Field(1, ge=0, le=10)


class Coverage(ExclusionSection):
    """Who watched too little of the videos.

    Attributes
    ----------
    below : float
        A smaller mean share of the videos of analysed trials excludes.
    """

    limit: ClassVar = ("<", "below")
    maker: ClassVar = watched_less

    rule: Literal["coverage"] = "coverage"
    below: float = Field(gt=0, le=1)


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
    maker: ClassVar = answered_too_fast

    rule: Literal["time"] = "time"
    below: float = Field(gt=0, le=3600)
    share: float = Field(0.5, gt=0, le=1)


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
    maker: ClassVar = straight_lined

    rule: Literal["straight_lining"] = "straight_lining"
    at_least: float = Field(gt=0.5, le=1)
    trials: int = Field(10, ge=2, le=1000)


EXCLUSION_SECTIONS: Final[tuple[type[ExclusionSection], ...]] = (
    *(Incomplete, FailedCatch, FailedAttention, Coverage, Time, StraightLining),
)
"""All of them."""

Exclusion = Annotated[
    Incomplete | FailedCatch | FailedAttention | Coverage | Time | StraightLining,
    Field(discriminator="rule"),
]
"""An entry of ``[[exclusions]]``."""

Checks = Catch | Attention


def exclusion_problems(
    exclusions: Sequence[ExclusionSection] | None, catch: Catch, attention: Attention
) -> list[str]:
    """Return what does not fit together between the rules and what they look at."""
    if exclusions is None:
        return []
    names = [each.rule for each in exclusions]
    twice = sorted({name for name in names if names.count(name) > 1})
    return [
        *([f"exclusions: the rule {listed(twice)} is stated twice"] if twice else []),
        *_limit_problems(exclusions, "catch", catch),
        *_limit_problems(exclusions, "attention", attention),
    ]


def _limit_problems(exclusions: Sequence[ExclusionSection], name: str, checks: Checks) -> list[str]:
    """Return where the rule `name` and the section of the same name contradict each other."""
    stated = [each for each in exclusions if each.rule == name]
    if stated and not checks.trials:
        return [f"exclusions: the rule {name!r} has nothing to look at, as {name}.trials is 0"]
    if not checks.trials or "max_failed" not in checks.model_fields_set:
        return []
    if not stated:
        return [
            f"{name}.max_failed excludes nobody, as exclusions do not name the rule {name!r}: "
            "add it, or leave max_failed out"
        ]
    return [
        f"exclusions: the rule {name!r} says more_than = {each.more_than}, and {name}.max_failed "
        f"says {checks.max_failed}: keep one of them"
        for each in stated
        if isinstance(each, FailedCatch | FailedAttention)
        and "more_than" in each.model_fields_set
        and each.more_than != checks.max_failed
    ]


def settle_exclusions(
    exclusions: Sequence[ExclusionSection] | None, catch: Catch, attention: Attention
) -> tuple[ExclusionSection, ...]:
    """Return the rules in order, with every number they depend on.

    Without any stated, who is unfinished is left out, then who failed too many catch trials and
    attention checks, as far as the study has them.
    """
    if exclusions is None:
        exclusions = (
            Incomplete(),
            *((FailedCatch(),) if catch.trials else ()),
            *((FailedAttention(),) if attention.trials else ()),
        )
    limits = {"catch": catch.max_failed, "attention": attention.max_failed}
    return tuple(
        each.model_copy(update={"more_than": limits[each.rule]})
        if isinstance(each, FailedCatch | FailedAttention)
        and "more_than" not in each.model_fields_set
        else each
        for each in exclusions
    )
