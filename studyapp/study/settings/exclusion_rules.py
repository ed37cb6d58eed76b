"""The exclusion rules of a whole study, settled before answers can be seen."""

from __future__ import annotations

from collections.abc import Sequence

from motion.listing import listed
from studyapp.study.settings.conditions import Attention, Catch
from studyapp.study.settings.exclusions import (
    ExclusionSection,
    FailedAttention,
    FailedCatch,
    Incomplete,
)

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


def settled(
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
