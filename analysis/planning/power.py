"""How often a study of one size finds a difference of one size."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from analysis.planning.deciding_tests import (
    LEVEL,
    BlockTests,
    DecidingTests,
    decided_by_holm,
    detection_shares,
)
from analysis.planning.part import Opinions, Part, Trials, simulate_answers
from motion.arrays import Floats

AT_ONCE: Final = 400_000
"""Answers held in memory at once."""

BATCH: Final = 20
"""Studies analysed by models between two checks of the precision."""

FEWEST_EXACT: Final = 40
"""Fewest studies analysed by models."""


NULL_BLOCKS: Final = 500
"""Simulated blocks without an effect, with which others are corrected."""


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How much is simulated.

    Attributes
    ----------
    quick : int
        Blocks for the quick tests.
    exact : int
        Most blocks to which models are fitted.
    precision : float
        No more models are fitted once the Monte-Carlo standard error of the power is this small.
    """

    quick: int = 2000
    exact: int = 400
    precision: float = 0.02


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
    alone, uncorrected : float
        The same if no other block of tests has the effect, and without correction.
    studies, modelled : int
        Blocks that were simulated, and those to which a model was fitted; no model is fitted if the
        report's test uses none.
    reason : str
        Why there is no power; empty if there is.
    """

    part: str
    effect: float
    power: float = math.nan
    error: float = math.nan
    alone: float = math.nan
    uncorrected: float = math.nan
    studies: int = 0
    modelled: int = 0
    reason: str = ""


def simulate_power(
    parts: Sequence[Part], opinions: Opinions, effect: float, effort: Effort, seed: Sequence[int]
) -> tuple[Power, ...]:
    """Simulate a study and return how often it finds `effect`, part by part.

    Quick tests analyse all blocks of every part. If the report decides by a model, the model
    analyses some of the blocks too, and the mean difference of the two corrects the share that the
    quick test finds (a control variate; Owen 2013, Monte Carlo theory, ch. 8.9).

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
    pools = [
        _Pool.of(part, opinions, effect, effort, [*seed, n, 1]) for n, part in enumerate(parts)
    ]
    fewer = replace(effort, quick=min(effort.quick, NULL_BLOCKS), exact=0)
    nulls = [
        _Pool.of(part, opinions, 0.0, fewer, [*seed, n, 0]).quick.p_values
        if effect
        else pool.quick.p_values
        for n, (part, pool) in enumerate(zip(parts, pools, strict=True))
    ]
    return tuple(
        _power(number, parts, pools, nulls, effect, effort, int(seed[0]))
        for number in range(len(parts))
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


@dataclass(frozen=True, kw_only=True, eq=False)
class _Pool:
    """Simulated blocks of one part, and the answers of those that models are fitted to."""

    tests: DecidingTests
    quick: BlockTests
    kept: Floats

    @classmethod
    def of(
        cls, part: Part, opinions: Opinions, effect: float, effort: Effort, seed: Sequence[int]
    ) -> _Pool:
        tests = DecidingTests(part)
        width = part.trials.conditions if part.kind != "pairs" else 1
        chunk = max(1, AT_ONCE // max(1, len(part.trials.items) * width))
        keep = effort.exact if any(tests.by_model) else 0
        results: list[BlockTests] = []
        kept: list[Floats] = []
        starts = range(0, effort.quick, chunk)
        seeds = np.random.SeedSequence(seed).spawn(len(starts))
        for start, chunk_seed in zip(starts, seeds, strict=True):
            count = min(chunk, effort.quick - start)
            answers = simulate_answers(
                part, opinions, effect, count, np.random.default_rng(chunk_seed)
            )
            results.append(tests.quick(answers))
            if start < keep:
                kept.append(
                    answers[: keep - start].astype(np.int8 if part.levels < 100 else np.int16)
                )
        return cls(
            tests=tests,
            quick=BlockTests.joined(results),
            kept=np.concatenate(kept) if kept else np.empty(0),
        )

    def first(self, count: int) -> BlockTests:
        return BlockTests(p_values=self.quick.p_values[:count], signs=self.quick.signs[:count])

    def exact(self, start: int, stop: int) -> BlockTests:
        return self.tests.exact(self.kept[start:stop].astype(np.float64))


def _power(
    number: int,
    parts: Sequence[Part],
    pools: Sequence[_Pool],
    nulls: Sequence[Floats],
    effect: float,
    effort: Effort,
    seed: int,
) -> Power:
    part, pool = parts[number], pools[number]
    true = [a == 0 for a, _ in pool.tests.pairs]
    family = {
        n: other.blocks - (n == number)
        for n, other in enumerate(parts)
        if other.family == part.family
    }
    with_effect = [(pools[n].quick.p_values, count) for n, count in family.items()]
    without = [(nulls[n], count) for n, count in family.items()]

    def shares(results: BlockTests) -> Mapping[str, Floats]:
        def share_of(decided: Floats) -> Floats:
            return detection_shares(results, decided, true, effect=effect)

        return {
            "power": share_of(decided_by_holm(results.p_values, with_effect, seed)),
            "alone": share_of(decided_by_holm(results.p_values, without, seed)),
            "uncorrected": share_of(np.asarray(results.p_values < LEVEL, np.float64)),
        }

    quick = shares(pool.quick)
    step = 1 / (sum(true) if effect else len(true))
    means, modelled, error = _corrected(pool, shares, quick, effort, step)
    return Power(
        part=part.name,
        effect=effect,
        power=means["power"],
        alone=means["alone"],
        uncorrected=means["uncorrected"],
        error=error,
        studies=len(pool.quick.p_values),
        modelled=modelled,
    )


def _corrected(
    pool: _Pool,
    shares: Callable[[BlockTests], Mapping[str, Floats]],
    quick: Mapping[str, Floats],
    effort: Effort,
    step: float,
) -> tuple[dict[str, float], int, float]:
    """Return the corrected mean shares, the number of models fitted, and the power's error.

    Parameters
    ----------
    step : float
        The contribution of one test to a block's share.
    """
    if not any(pool.tests.by_model):
        means = {name: float(each.mean()) for name, each in quick.items()}
        return means, 0, _error(quick["power"], step)
    exact: list[BlockTests] = []
    while True:
        done = sum(len(results.p_values) for results in exact)
        exact.append(pool.exact(done, min(done + BATCH, len(pool.kept))))
        done += len(exact[-1].p_values)
        by_model, by_quick = shares(BlockTests.joined(exact)), shares(pool.first(done))
        missed = {name: by_model[name] - by_quick[name] for name in quick}
        error = math.hypot(_error(quick["power"], step), _error(missed["power"], step))
        enough = done >= FEWEST_EXACT and error <= effort.precision
        if enough or done >= len(pool.kept):
            corrected = {
                name: min(1.0, max(0.0, float(quick[name].mean() + missed[name].mean())))
                for name in quick
            }
            return corrected, done, error


def _error(values: Floats, step: float) -> float:
    """Return the standard error of the mean of blocks' shares.

    One value of `step` and one of 0 are added, because a share of 0 or 1 also has an error.
    """
    padded = np.append(values, [step, 0.0])
    return float(np.sqrt(padded.var() / len(values)))
