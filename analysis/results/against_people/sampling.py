"""What so many conditions can show of a rank correlation at all.

Conditions are taken as drawn from a population in which the metric and people's preference are
jointly normal, both known without error. The law of a rank correlation then depends on the number
of conditions and on the correlation alone, and is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from analysis.results.against_people.result import SamplingRange

Floats = NDArray[np.float64]
Kind = Literal["kendall", "spearman"]

_SEED: Final = 20
_STUDIES: Final = 20_000
_STUDIES_ON_GRID: Final = 4_000
_GRID: Final = np.tanh(np.linspace(0, 3.8, 39))
"""Correlations of the normal law, from 0 to nearly 1."""
_BLOCK: Final = 2_000_000
"""Comparisons simulated at a time: bounds the memory."""


def sampling_range(conditions: int, tau: float = 0.5) -> SamplingRange:
    """Return between which values Kendall's tau lies in 95 % of studies, if it is `tau` truly.

    Parameters
    ----------
    conditions : int
        Of a study; at least two.
    tau : float
        Among all conditions, in [-1, 1].
    """
    chance = np.random.default_rng(_SEED)
    found = _simulated(chance, conditions, float(np.sin(np.pi * tau / 2)), _STUDIES)["kendall"]
    low, high = np.quantile(found, [0.025, 0.975])
    return SamplingRange(tau=tau, low=float(low), high=float(high), conditions=conditions)


def compatible(estimate: float, conditions: int, kind: Kind) -> tuple[float, float]:
    """Return the correlations of which `estimate` would be an ordinary sample.

    They are those whose 95 % sampling range holds it (the interval that inverts a test), so that
    few conditions give a wide interval even where they agree entirely.

    Parameters
    ----------
    estimate : float
        In [-1, 1].
    conditions : int
        That it was found in.
    kind : {'kendall', 'spearman'}
        Which correlation.
    """
    if estimate < 0:
        low, high = compatible(-estimate, conditions, kind)
        return -high, -low
    law = _laws(conditions)[kind]
    fits = (law.low <= estimate + 1e-9) & (estimate - 1e-9 <= law.high)
    places = np.flatnonzero(fits)
    if not len(places):
        return estimate, estimate
    # One step of the grid further on both sides, since the ends lie between its points.
    low = law.true[max(places[0] - 1, 0)]
    high = law.true[places[-1] + 1] if places[-1] + 1 < len(law.true) else 1.0
    if fits[0]:
        low = -1.0
    return float(low), float(high)


@dataclass(frozen=True)
class _Law:
    """Sampling ranges of true correlations, in ascending order."""

    true: Floats
    low: Floats
    high: Floats


@lru_cache(maxsize=64)
def _laws(conditions: int) -> dict[Kind, _Law]:
    chance = np.random.default_rng(_SEED)
    upper = [_simulated(chance, conditions, float(rho), _STUDIES_ON_GRID) for rho in _GRID]
    signed = np.concatenate([-_GRID[:0:-1], _GRID])
    true: dict[Kind, Floats] = {
        "kendall": 2 / np.pi * np.arcsin(signed),
        "spearman": 6 / np.pi * np.arcsin(signed / 2),
    }
    laws: dict[Kind, _Law] = {}
    for kind, truth in true.items():
        low, high = np.quantile([one[kind] for one in upper], [0.025, 0.975], axis=1)
        laws[kind] = _Law(
            truth, np.concatenate([-high[:0:-1], low]), np.concatenate([-low[:0:-1], high])
        )
    return laws


def _simulated(
    chance: np.random.Generator, conditions: int, rho: float, studies: int
) -> dict[Kind, Floats]:
    """Return what `studies` studies find where the normal law has the correlation `rho`."""
    one, other = np.triu_indices(conditions, 1)
    taus, rhos = [], []
    block = max(1, _BLOCK // len(one))
    for start in range(0, studies, block):
        shape = (min(block, studies - start), conditions)
        first = chance.standard_normal(shape)
        second = rho * first + np.sqrt(1 - rho**2) * chance.standard_normal(shape)
        agree = (first[:, one] > first[:, other]) == (second[:, one] > second[:, other])
        taus.append(2 * agree.mean(axis=1) - 1)
        apart = _ranks(first) - _ranks(second)
        rhos.append(1 - 6 * np.square(apart).sum(axis=1) / (conditions * (conditions**2 - 1)))
    return {"kendall": np.concatenate(taus), "spearman": np.concatenate(rhos)}


def _ranks(values: Floats) -> Floats:
    return np.asarray(np.argsort(np.argsort(values, axis=1), axis=1), np.float64)
