"""How often a study of one size finds a difference of one size."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.planning.deciding_tests import (
    LEVEL,
    Company,
    DecidingTests,
    Findings,
    decided_by_holm,
    right,
)
from analysis.planning.many_studies import drawn_answers
from analysis.planning.part import Opinions, Part, Trials

Floats = NDArray[np.float64]

AT_ONCE: Final = 400_000
"""Answers that are held in memory at once."""

TURN: Final = 20
"""Studies that are analysed by models before the precision is looked at."""

FEWEST_EXACT: Final = 40
"""Studies that are analysed by models at least."""


COMPANY: Final = 500
"""Blocks without an effect that others are corrected together with."""


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How much is simulated.

    Attributes
    ----------
    quick : int
        Blocks that the quick tests see.
    exact : int
        Blocks that models are fitted to, at most.
    precision : float
        No more models are fitted once the Monte-Carlo standard error of the power is below it.
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
        Its name; empty where a study has no parts.
    effect : float
        By how much one condition is better than all others, in logits.
    power, error : float
        The share of true differences that the report finds in the right direction, where all of
        its comparisons and questions have the effect, and its Monte-Carlo standard error. With an
        effect of 0, the share of tests that find what is not there.
    alone, uncorrected : float
        The same where no other block of tests has the effect, and without correction.
    studies, modelled : int
        Blocks that were simulated, and those of them that a model was fitted to; 0 where the
        report's test is no model's.
    reason : str
        Why there is no power; empty where there is.
    """

    part: str
    effect: float
    power: float
    error: float
    alone: float
    uncorrected: float
    studies: int
    modelled: int
    reason: str = ""


def power_of(
    parts: Sequence[Part], opinions: Opinions, effect: float, effort: Effort, seed: Sequence[int]
) -> tuple[Power, ...]:
    """Simulate a study and return how often it finds `effect`, part by part.

    Every part's blocks are drawn and tested quickly. Where the report decides by a model, some of
    them are tested by it too, and the mean difference of what the two decide corrects the share
    that the quick test finds (a control variate; Owen 2013, Monte Carlo theory, ch. 8.9).

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
        return tuple(_unknown(part.name, effect, "; ".join(untested)) for part in parts)
    pools = [
        _Pool.of(part, opinions, effect, effort, [*seed, n, 1]) for n, part in enumerate(parts)
    ]
    fewer = replace(effort, quick=min(effort.quick, COMPANY), exact=0)
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
    for count, name in ((trials.analysed, "participant"), (trials.shown_items, "segment")):
        if count == 1:
            return f"one {name} allows no test of what holds for others"
    return ""


def _unknown(part: str, effect: float, reason: str) -> Power:
    none = math.nan
    return Power(
        part=part,
        effect=effect,
        power=none,
        error=none,
        alone=none,
        uncorrected=none,
        studies=0,
        modelled=0,
        reason=reason,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Pool:
    """Simulated blocks of one part, and how models come to those among them that are kept."""

    tests: DecidingTests
    quick: Findings
    kept: Floats
    sides: NDArray[np.bool_]

    @classmethod
    def of(
        cls, part: Part, opinions: Opinions, effect: float, effort: Effort, seed: Sequence[int]
    ) -> _Pool:
        tests = DecidingTests(part, opinions, effect)
        width = part.trials.conditions if part.kind != "pairs" else 1
        chunk = max(1, AT_ONCE // max(1, len(part.trials.items) * width))
        keep = effort.exact if any(tests.by_model) else 0
        found: list[Findings] = []
        kept: list[Floats] = []
        starts = range(0, effort.quick, chunk)
        for start, one in zip(starts, np.random.SeedSequence(seed).spawn(len(starts)), strict=True):
            count = min(chunk, effort.quick - start)
            given = drawn_answers(part, opinions, effect, count, np.random.default_rng(one))
            found.append(tests.quick(given))
            if start < keep:
                kept.append(
                    given[: keep - start].astype(np.int8 if part.levels < 100 else np.int16)
                )
        left, right_ = part.trials.left, part.trials.right
        return cls(
            tests=tests,
            quick=Findings(
                p_values=np.concatenate([one.p_values for one in found]),
                signs=np.concatenate([one.signs for one in found]),
            ),
            kept=np.concatenate(kept) if kept else np.empty(0),
            sides=np.empty(0, bool) if left is None or right_ is None else left > right_,
        )

    def first(self, count: int) -> Findings:
        return Findings(p_values=self.quick.p_values[:count], signs=self.quick.signs[:count])

    def exact(self, start: int, stop: int) -> Findings:
        return self.tests.exact(self.kept[start:stop].astype(np.float64), self.sides)


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
    family = [n for n, other in enumerate(parts) if other.family == part.family]
    counts = tuple(parts[n].blocks - (n == number) for n in family)

    def shares(found: Findings) -> Mapping[str, Floats]:
        def of(decided: Floats) -> Floats:
            return right(found, decided, true, effect=effect)

        beside = Company(pools=tuple(pools[n].quick.p_values for n in family), counts=counts)
        without = Company(pools=tuple(nulls[n] for n in family), counts=counts)
        return {
            "power": of(decided_by_holm(found.p_values, beside, seed)),
            "alone": of(decided_by_holm(found.p_values, without, seed)),
            "uncorrected": of(_below(found)),
        }

    quick = shares(pool.quick)
    step = 1 / (sum(true) if effect else len(true))
    found, modelled, error = _corrected(pool, shares, quick, effort, step)
    return Power(
        part=part.name,
        effect=effect,
        power=found["power"],
        error=error,
        alone=found["alone"],
        uncorrected=found["uncorrected"],
        studies=len(pool.quick.p_values),
        modelled=modelled,
    )


def _below(found: Findings) -> Floats:
    return np.asarray(found.p_values < LEVEL, np.float64)


def _corrected(
    pool: _Pool,
    shares: Callable[[Findings], Mapping[str, Floats]],
    quick: Mapping[str, Floats],
    effort: Effort,
    step: float,
) -> tuple[dict[str, float], int, float]:
    """Return the shares, from how many models, and the error of the power among them.

    Parameters
    ----------
    step : float
        What one test contributes to a block's share.
    """
    if not any(pool.tests.by_model):
        means = {name: float(each.mean()) for name, each in quick.items()}
        return means, 0, _error(quick["power"], step)
    exact: list[Findings] = []
    while True:
        done = sum(len(one.p_values) for one in exact)
        exact.append(pool.exact(done, min(done + TURN, len(pool.kept))))
        done += len(exact[-1].p_values)
        models = Findings(
            p_values=np.concatenate([one.p_values for one in exact]),
            signs=np.concatenate([one.signs for one in exact]),
        )
        by_model, by_quick = shares(models), shares(pool.first(done))
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

    One value of `step` and one of 0 are added: a share of 0 or 1 is not known without error.
    """
    more = np.append(values, [step, 0.0])
    return float(np.sqrt(more.var() / len(values)))
