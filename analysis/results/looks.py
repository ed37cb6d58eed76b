"""Looks at results before the answers that a report rests on, and what they may have done."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from analysis.stats.multiple_testing import LEVEL, false_positive_rate


@dataclass(frozen=True, kw_only=True)
class Look:
    """One look, or several in a row that are alike.

    Attributes
    ----------
    day : str
        In UTC, as ``2026-05-04``.
    by : str
        ``researcher 1``, ``researcher 2`` …, or ``command line``.
    way : {'page', 'report', 'export'}
        Where results were seen.
    reason : str
        In their words; empty where none was given.
    finished, planned : int
        Participants who had finished, and who were wanted.
    answers : int
        Answers that had been given.
    times : int
        How many looks in a row these are.
    """

    day: str
    by: str
    way: str
    reason: str
    finished: int
    planned: int
    answers: int
    times: int = 1


@dataclass(frozen=True, kw_only=True)
class LooksBefore:
    """All looks at fewer or other answers than those that are reported.

    Attributes
    ----------
    count : int
        How many there were.
    looks : tuple of Look
        The first one first.
    finished : tuple of int
        How many participants had finished at them, each number once, ascending.
    false_positive_rate : float
        How often something is found where nothing is, by who ends a study at the first of these
        looks that finds something; the reported answers are the last one. NaN without looks.
    level : float
        Of each test.
    reason : str
        Why there is no rate.
    """

    count: int
    looks: tuple[Look, ...]
    finished: tuple[int, ...]
    false_positive_rate: float
    level: float
    reason: str


def looks_before(looks: Sequence[Look], *, finished: int, answers: int) -> LooksBefore:
    """Leave out looks at the very answers that are reported, and judge the others.

    Parameters
    ----------
    looks : sequence of Look
        All that are logged, the first one first.
    finished, answers : int
        How far the study is in what is reported.
    """
    before = [look for look in looks if (look.finished, look.answers) != (finished, answers)]
    numbers = {look.finished for look in before if look.finished > 0}
    return LooksBefore(
        count=sum(look.times for look in before),
        looks=_gathered(before),
        finished=tuple(sorted({look.finished for look in before})),
        false_positive_rate=false_positive_rate(sorted(numbers | {finished}))
        if numbers and finished
        else math.nan,
        level=LEVEL,
        reason=_why_no_rate(before, bool(numbers and finished)),
    )


NOT_LOGGED: Final = LooksBefore(
    count=0,
    looks=(),
    finished=(),
    false_positive_rate=math.nan,
    level=LEVEL,
    reason="looks at a table of answers are not logged",
)
"""Of a table, and of a rehearsal."""


def _why_no_rate(before: Sequence[Look], is_known: bool) -> str:
    if is_known:
        return ""
    return "no participant had finished" if before else "no look is logged"


def _gathered(looks: Sequence[Look]) -> tuple[Look, ...]:
    """Count looks in a row that differ in nothing."""
    gathered: list[Look] = []
    for look in looks:
        if gathered and replace(gathered[-1], times=look.times) == look:
            gathered[-1] = replace(gathered[-1], times=gathered[-1].times + look.times)
        else:
            gathered.append(look)
    return tuple(gathered)
