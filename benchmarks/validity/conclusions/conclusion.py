"""A number of a simulated study's report, and the kind of study that it belongs to."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import stats

from analysis.stats.clustered_mean import Estimate
from analysis.stats.strength_differences import TwoWayErrors, difference_tests, rank_intervals
from benchmarks.validity.studies import Design

Floats = np.typing.NDArray[np.float64]

EFFECT: Final = 0.4
"""Effect of the studies that have one, in logits."""

Z_95: Final = float(stats.norm.ppf(0.975))


@dataclass(frozen=True, kw_only=True)
class Conclusion:
    """A number of one study's report.

    Attributes
    ----------
    p_value : float
        P value of the null hypothesis; NaN where the report gives none.
    low, high : float
        Ends of the 95% interval; NaN where the report gives none.
    """

    p_value: float
    low: float = math.nan
    high: float = math.nan


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """A kind of study.

    Attributes
    ----------
    conclude : callable
        Simulates one study of a design and returns its conclusions by name.
    truths : callable
        Returns the truths of a design, by the names of the conclusions that have intervals.
    naive : tuple of str
        Conclusions that treat answers as independent, as papers do.
    effects : (float, float)
        Effects of the studies without and with something to find.
    """

    conclude: Callable[[Design, np.random.Generator], Mapping[str, Conclusion]]
    truths: Callable[[Design], Mapping[str, float]]
    naive: tuple[str, ...] = ()
    effects: tuple[float, float] = (0.0, EFFECT)


def no_truths(_: Design) -> Mapping[str, float]:
    """Return the truths of conclusions that have no interval."""
    return {}


def of_mean(value: Estimate) -> Conclusion:
    """Return the conclusion of a clustered mean."""
    return Conclusion(p_value=value.p_value, low=value.low, high=value.high)


def of_error(estimate: float, error: float, freedom: float = math.inf) -> Conclusion:
    """Return the conclusion of an estimate by its standard error; nothing without one."""
    if not error > 0:
        return Conclusion(p_value=math.nan)
    law = stats.t(freedom)
    reach = float(law.ppf(0.975)) * error
    return Conclusion(
        p_value=float(2 * law.sf(abs(estimate) / error)),
        low=float(estimate - reach),
        high=float(estimate + reach),
    )


def of_two_way(strengths: Floats, value: TwoWayErrors | None) -> Conclusion:
    """Return the conclusion of the first strength by its two-way error."""
    if value is None or not np.isfinite(strengths).all():
        return Conclusion(p_value=math.nan)
    return of_error(float(strengths[0]), float(value.errors[0]), float(value.freedoms[0]))


def of_ranks(strengths: Floats, value: TwoWayErrors | None, *, effect: float) -> Conclusion:
    """Return whether rank intervals separate conditions, and whether all contain the truth.

    With an effect, the first condition is the best; all others are equally good and may share their
    ranks in any order. The interval is 1 to 1 if all true ranks are inside, else 2 to 2; its truth
    is 1.
    """
    if value is None or not np.isfinite(strengths).all():
        return Conclusion(p_value=math.nan)
    count = len(strengths)
    ranks = rank_intervals(strengths, difference_tests(strengths, value))
    first_shared = 2 if effect > 0 else 1
    inside = ranks[0][0] == 1 and (effect > 0 or ranks[0][1] == count)
    inside &= all(best <= first_shared and worst == count for best, worst in ranks[1:])
    apart = any(interval != (1, count) for interval in ranks)
    shown = 1.0 if inside else 2.0
    return Conclusion(p_value=0.0 if apart else 1.0, low=shown, high=shown)


RANKS_HOLD: Final = 1.0
"""The truth of the interval of `of_ranks`."""
