"""`[[exclusions]]`: rules that exclude participants from the analysis."""

from collections.abc import Callable, Mapping, Sequence
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
        The operator in the rule's shorthand, and the key of the number that follows; None for a
        rule without a number.
    maker : callable
        Makes the rule from the section's other keys, in order.
    """

    limit: ClassVar[tuple[str, str] | None] = None
    maker: ClassVar[Callable[..., ExclusionRule]]

    rule: str

    def to_rule(self) -> ExclusionRule:
        """Return the rule."""
        return type(self).maker(*self.model_dump(exclude={"rule"}).values())

    def shorthand(self) -> str:
        """Return the rule in one word, such as ``catch>1``."""
        settings = self.model_dump(exclude={"rule"})
        word = self.rule
        if self.limit is not None:
            operator, key = self.limit
            word += f"{operator}{settings.pop(key):g}"
        return ",".join([word, *(f"{key}={value:g}" for key, value in settings.items())])


class Incomplete(ExclusionSection):
    """Excludes participants who did not finish all trials."""

    maker: ClassVar = incomplete

    rule: Literal["incomplete"] = "incomplete"


class FailedCatch(ExclusionSection):
    """Excludes participants who failed too many catch trials.

    Attributes
    ----------
    more_than : int
        More failed catch trials exclude; by default, `Catch.max_failed`.
    """

    limit: ClassVar = (">", "more_than")
    maker: ClassVar = failed_catch_trials

    rule: Literal["catch"] = "catch"
    more_than: int = Field(1, ge=0, le=20)


class FailedAttention(ExclusionSection):
    """Excludes participants who failed too many attention checks.

    Attributes
    ----------
    more_than : int
        More failed checks exclude; by default, `Attention.max_failed`.
    """

    limit: ClassVar = (">", "more_than")
    maker: ClassVar = failed_attention_checks

    rule: Literal["attention"] = "attention"
    more_than: int = Field(1, ge=0, le=10)


class Coverage(ExclusionSection):
    """Excludes participants who watched too little of the videos.

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
    """Excludes participants who answered too fast.

    Attributes
    ----------
    below : float
        A shorter time from the first showing of a trial to its answer, in seconds, is too fast.
    share : float
        This share of trials that are too fast excludes; one half is a rule about the median.
    """

    limit: ClassVar = ("<", "below")
    maker: ClassVar = answered_too_fast

    rule: Literal["time"] = "time"
    below: float = Field(gt=0, le=3600)
    share: float = Field(0.5, gt=0, le=1)


class StraightLining(ExclusionSection):
    """Excludes participants who repeat one answer to a question.

    Attributes
    ----------
    at_least : float
        This share of the most frequent answer to a question excludes.
    trials : int
        Questions that a participant answered less often are ignored.
    """

    limit: ClassVar = (">=", "at_least")
    maker: ClassVar = straight_lined

    rule: Literal["straight_lining"] = "straight_lining"
    at_least: float = Field(gt=0.5, le=1)
    trials: int = Field(10, ge=2, le=1000)


EXCLUSION_SECTIONS: Final[Mapping[str, type[ExclusionSection]]] = {
    str(section.model_fields["rule"].default): section
    for section in (Incomplete, FailedCatch, FailedAttention, Coverage, Time, StraightLining)
}
"""All of them by rule."""

Exclusion = Annotated[
    Incomplete | FailedCatch | FailedAttention | Coverage | Time | StraightLining,
    Field(discriminator="rule"),
]
"""An entry of ``[[exclusions]]``."""


def exclusion_problems(
    exclusions: Sequence[ExclusionSection] | None, catch: Catch, attention: Attention
) -> list[str]:
    """Return contradictions among the rules, and with catch trials and attention checks."""
    rules = exclusions or ()
    names = [rule.rule for rule in rules]
    repeated = sorted({name for name in names if names.count(name) > 1})
    checks: dict[str, Catch | Attention] = {"catch": catch, "attention": attention}
    return [
        *([f"exclusions: the rule {listed(repeated)} is stated twice"] if repeated else []),
        *(
            f"exclusions: the rule {rule.rule!r} has more_than = {rule.more_than}, but "
            f"{rule.rule}.max_failed is {checks[rule.rule].max_failed}: remove one of them"
            for rule in rules
            if isinstance(rule, FailedCatch | FailedAttention)
            and "more_than" in rule.model_fields_set
            and checks[rule.rule].model_fields_set >= {"max_failed"}
            and rule.more_than != checks[rule.rule].max_failed
        ),
    ]


def settle_exclusions(
    exclusions: Sequence[ExclusionSection] | None, catch: Catch, attention: Attention
) -> tuple[ExclusionSection, ...]:
    """Return the rules in order, with all their numbers.

    Without stated rules, participants are excluded who did not finish, then those who failed too
    many catch trials and attention checks, if the study has any.
    """
    if exclusions is None:
        exclusions = (
            Incomplete(),
            *((FailedCatch(),) if catch.trials else ()),
            *((FailedAttention(),) if attention.trials else ()),
        )
    limits = {"catch": catch.max_failed, "attention": attention.max_failed}
    return tuple(
        rule.model_copy(update={"more_than": limits[rule.rule]})
        if rule.rule in limits and "more_than" not in rule.model_fields_set
        else rule
        for rule in exclusions
    )
