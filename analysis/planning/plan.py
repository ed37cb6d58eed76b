"""A plan: its request, simulated studies, and the smallest difference that they find."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from scipy.stats import norm

from analysis.planning.part import Opinions, Size, describe_effect
from analysis.planning.power import STUDIES, Power, simulate_power

TARGET_POWER: Final = 0.8
"""The power at which a plan aims."""

LARGEST: Final = 4.0

SMALLEST: Final = 0.02
"""Differences beyond these, in logits, are not searched for."""

_SURE: Final = 1e-4


@dataclass(frozen=True, kw_only=True)
class Request:
    """A request for a plan.

    Attributes
    ----------
    size : callable
        Returns the study for a number of participants and of segments.
    participants, items : tuple of int
        Numbers to try; participants are counted per comparison if `per_comparison`.
    effects : tuple of float
        Differences to try, in logits.
    current : (int, int) or None
        Participants and segments of the study as it stands; None if there is no study yet.
    per_comparison : bool
        Whether each comparison has separate participants.
    opinions : Opinions
        How people answer.
    source : str
        Where `opinions` come from, in words.
    excluded : float
        Share of participants who will be excluded.
    seed : int
        The same seed gives the same numbers.
    notes : tuple of str
        Further sentences about the study.
    studies : int
        Simulated studies of each size and effect.
    """

    size: Callable[[int, int], Size]
    participants: tuple[int, ...]
    items: tuple[int, ...]
    effects: tuple[float, ...]
    current: tuple[int, int] | None
    per_comparison: bool
    opinions: Opinions
    source: str
    excluded: float
    seed: int
    notes: tuple[str, ...] = ()
    studies: int = STUDIES

    def powers(self, size: Size, effect: float) -> tuple[Power, ...]:
        """Simulate the studies of one size, and return the power of each part.

        The noise is the same for every effect, so that powers rise smoothly with it.
        """
        seed = (self.seed, *size.numbers)
        return simulate_power(size.parts, self.opinions, effect, seed, self.studies)


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The power of a study of one size for one effect, by part."""

    size: Size
    powers: tuple[Power, ...]


@dataclass(frozen=True, kw_only=True)
class Smallest:
    """The smallest difference that the study as it stands finds with power .8.

    Attributes
    ----------
    part : str
        The part of the study.
    effect : float
        In logits; NaN if there is none.
    in_answers : str
        The effect in words.
    reason : str
        Why there is none.
    """

    part: str
    effect: float
    in_answers: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Plan:
    """The results of simulated studies.

    Attributes
    ----------
    request : Request
        The request.
    cells : tuple of Cell
        By segments, participants and effect, in the order of the request.
    meanings : mapping of (str, float) to str
        Each effect in terms of answers, by part and effect.
    tests : mapping of str to int
        Number of tests that are corrected together, by part.
    smallest : tuple of Smallest
        The smallest difference of each part; empty if there is no study yet.
    """

    request: Request
    cells: tuple[Cell, ...]
    meanings: dict[tuple[str, float], str]
    tests: dict[str, int]
    smallest: tuple[Smallest, ...]

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the study's parts."""
        return tuple(power.part for power in self.cells[0].powers)

    def power(self, part: int, participants: int, items: int, effect: float) -> Power:
        """Return the power of a part, given by its index, in one of the cells."""
        return next(
            cell.powers[part]
            for cell in self.cells
            if cell.size.numbers == (participants, items) and cell.powers[part].effect == effect
        )


def plan(request: Request, show: Callable[[int, int], None] | None = None) -> Plan:
    """Simulate everything requested; `show` gets the numbers of finished and of all cells."""
    sizes = {(p, i): request.size(p, i) for i, p in product(request.items, request.participants)}
    cells: list[Cell] = []
    for size, effect in product(sizes.values(), request.effects):
        cells.append(Cell(size=size, powers=request.powers(size, effect)))
        if show is not None:
            show(len(cells), len(sizes) * len(request.effects))
    smallest: tuple[Smallest, ...] = ()
    if request.current is not None:
        own_size = sizes.get(request.current) or request.size(*request.current)
        smallest = _smallest(request, own_size, cells)
    first = next(iter(sizes.values()))
    return Plan(
        request=request,
        cells=tuple(cells),
        meanings={
            (part.name, effect): describe_effect(part, request.opinions, effect)
            for part in first.parts
            for effect in request.effects
        },
        tests={
            part.name: sum(other.tests for other in first.parts if other.family == part.family)
            for part in first.parts
        },
        smallest=smallest,
    )


def _smallest(request: Request, size: Size, cells: Sequence[Cell]) -> tuple[Smallest, ...]:
    """Search for the smallest difference that a study of one size finds, by part."""
    powers = cache(lambda effect: request.powers(size, effect))
    smallest = []
    for number, part in enumerate(size.parts):

        def power_at(effect: float, number: int = number) -> float:
            return powers(effect)[number].power

        known = [cell.powers[number] for cell in cells if cell.size.numbers == size.numbers]
        found = {power.effect: power.power for power in known if power.effect > 0}
        effect, reason = smallest_effect(found or {_FIRST: power_at(_FIRST)}, power_at)
        smallest.append(
            Smallest(
                part=part.name,
                effect=effect,
                in_answers="" if reason else describe_effect(part, request.opinions, effect),
                reason=reason,
            )
        )
    return tuple(smallest)


_FIRST: Final = 0.4


def smallest_effect(
    known: Mapping[float, float], power_at: Callable[[float], float]
) -> tuple[float, str]:
    """Return the smallest difference that is found, or why there is none.

    Between two simulated differences, the probit of the power is interpolated linearly.

    Parameters
    ----------
    known : mapping of float to float
        The powers of some differences above 0, by their size in logits.
    power_at : callable
        Simulates the power of another difference.
    """
    powers = dict(sorted(known.items()))
    if any(math.isnan(power) for power in powers.values()):
        return math.nan, "there is no test"
    while max(powers.values()) < TARGET_POWER:
        larger = 1.5 * max(powers)
        if larger > LARGEST:
            return math.nan, f"not even a difference of {max(powers):.2g} logits is found so often"
        powers[larger] = power_at(larger)
    while min(powers.values()) >= TARGET_POWER:
        smaller = min(powers) / 2
        if smaller < SMALLEST:
            return math.nan, f"even a difference of {min(powers):.2g} logits is found so often"
        powers[smaller] = power_at(smaller)
    above = min(effect for effect, power in powers.items() if power >= TARGET_POWER)
    below = max(effect for effect in powers if effect < above)
    found = np.clip([powers[below], powers[above]], _SURE, 1 - _SURE)
    low, high, wanted = np.asarray(norm.ppf([*found, TARGET_POWER])).tolist()
    share = (wanted - low) / (high - low)
    return below + share * (above - below), ""
