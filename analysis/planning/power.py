"""How often a study of one size finds a difference of one size."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.planning.deciding_tests import (
    LEVEL,
    BlockTests,
    block_tests,
    decided_by_holm,
    detection_shares,
)
from analysis.planning.part import Opinions, Part, Trials, simulate_answers
from motion.arrays import Floats

STUDIES: Final = 1000
"""Simulated studies of each size and effect."""

AT_ONCE: Final = 400_000
"""Answers held in memory at once."""


@dataclass(frozen=True, kw_only=True)
class Power:
    """How often differences are found in one part of a study.

    Attributes
    ----------
    part : str
        The part's name; empty if a study has no parts.
    effect : float
        How much better one condition is than all others, in logits.
    power, error : float
        The share of true differences that the report finds in the right direction, if all of its
        comparisons and questions have the effect, and its Monte-Carlo standard error. With an
        effect of 0, the share of tests that are significant.
    uncorrected : float
        The same without correction for many tests.
    reason : str
        Why there is no power; empty if there is.
    """

    part: str
    effect: float
    power: float = math.nan
    error: float = math.nan
    uncorrected: float = math.nan
    reason: str = ""


def simulate_power(
    parts: Sequence[Part],
    opinions: Opinions,
    effect: float,
    seed: Sequence[int],
    studies: int,
) -> tuple[Power, ...]:
    """Simulate a study and return how often it finds `effect`, part by part.

    Parameters
    ----------
    parts : sequence of Part
        All parts of the study.
    seed : sequence of int
        The same seed gives the same numbers.
    """
    untested = dict.fromkeys(filter(None, (_why_untested(part.trials) for part in parts)))
    if untested:
        # A family is simulated whole or not at all.
        reason = "; ".join(untested)
        return tuple(Power(part=part.name, effect=effect, reason=reason) for part in parts)
    blocks = [
        _simulated(part, opinions, effect, studies, [*seed, number])
        for number, part in enumerate(parts)
    ]
    return tuple(
        _power(number, parts, blocks, effect, int(seed[0])) for number in range(len(parts))
    )


def _why_untested(trials: Trials) -> str:
    if not len(trials.participants):
        return "nobody is left to judge anything"
    for count, name in (
        (trials.analysed, "participant"),
        (len(np.unique(trials.items)), "segment"),
    ):
        if count == 1:
            return f"one {name} allows no test of what holds for others"
    return ""


def _simulated(
    part: Part, opinions: Opinions, effect: float, studies: int, seed: Sequence[int]
) -> BlockTests:
    """Return the tests of one block of a part in many studies."""
    width = part.trials.conditions if part.kind != "pairs" else 1
    chunk = max(1, AT_ONCE // (len(part.trials.items) * width))
    generator = np.random.default_rng(seed)
    tests = [
        block_tests(
            part, simulate_answers(part, opinions, effect, min(chunk, studies - start), generator)
        )
        for start in range(0, studies, chunk)
    ]
    p_values, signs = (np.concatenate(column) for column in zip(*tests, strict=True))
    return BlockTests(p_values=p_values, signs=signs)


def _power(
    number: int, parts: Sequence[Part], blocks: Sequence[BlockTests], effect: float, seed: int
) -> Power:
    part, (p_values, signs) = parts[number], blocks[number]
    true = [a == 0 for a, _ in part.trials.pairs]
    family = [
        (blocks[n].p_values, other.blocks - (n == number))
        for n, other in enumerate(parts)
        if other.family == part.family
    ]
    decided = decided_by_holm(p_values, family, seed)
    alone = np.asarray(p_values < LEVEL, np.float64)
    found, uncorrected = (
        detection_shares(signs, each, true, effect=effect) for each in (decided, alone)
    )
    return Power(
        part=part.name,
        effect=effect,
        power=float(found.mean()),
        error=_error(found, 1 / (sum(true) if effect else len(true))),
        uncorrected=float(uncorrected.mean()),
    )


def _error(values: Floats, step: float) -> float:
    """Return the standard error of the mean of blocks' shares.

    One value of `step`, what one test contributes to a share, and one of 0 are added, because a
    share of 0 or 1 also has an error.
    """
    padded = np.append(values, [step, 0.0])
    return float(np.sqrt(padded.var() / len(values)))
