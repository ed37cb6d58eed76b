"""A plan: what is asked, what simulated studies answer, and the smallest difference they find."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Final

from scipy.stats import norm

from analysis.planning.grid import Cell, Runner, Task, estimate_minutes, limit_effort
from analysis.planning.part import Opinions, Size, describe_effect
from analysis.planning.power import Effort, Power

WANTED: Final = 0.8
"""The power that a plan aims at."""

LARGEST: Final = 4.0

SMALLEST: Final = 0.02
"""Differences beyond these are not looked for, in logits."""

_SURE: Final = 1e-4


@dataclass(frozen=True, kw_only=True)
class Request:
    """What a plan is asked for.

    Attributes
    ----------
    title : str
        The study's title.
    protocol : str
        Its name.
    size : callable
        From numbers of participants and segments to the study of that size.
    participants, items : tuple of int
        Numbers that are tried; of participants, those of each comparison where `per_comparison`.
    effects : tuple of float
        Differences that are tried, in logits.
    own : (int, int) or None
        Participants and segments of the study as it stands; None where there is none yet.
    per_comparison : bool
        Whether each comparison has participants of its own.
    opinions : Opinions
        How people answer.
    source : str
        Where `opinions` come from, in words.
    excluded : float
        Share of participants who will be left out.
    pay : float or None
        What one participant costs, fees included; None where that is not known.
    effort : Effort
        How much is simulated.
    minutes : float
        About how long it may take, on two processors.
    seed : int
        The same seed gives the same numbers.
    notes : tuple of str
        What else must be known of the study, as sentences.
    """

    title: str
    protocol: str
    size: Callable[[int, int], Size]
    participants: tuple[int, ...]
    items: tuple[int, ...]
    effects: tuple[float, ...]
    own: tuple[int, int] | None
    per_comparison: bool
    opinions: Opinions
    source: str
    excluded: float
    pay: float | None
    effort: Effort
    minutes: float
    seed: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Smallest:
    """The smallest difference that the study as it stands finds with power .8.

    Attributes
    ----------
    part : str
        The part of the study.
    effect : float
        In logits; NaN where there is none.
    in_answers : str
        The same in words.
    reason : str
        Why there is none.
    """

    part: str
    effect: float
    in_answers: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What simulated studies answer.

    Attributes
    ----------
    request : Request
        What was asked.
    cells : tuple of Cell
        By segments, participants and effect, in the order asked.
    meanings : mapping of (str, float) to str
        What an effect means in answers, by part and effect.
    tests : mapping of str to int
        By part, how many tests are corrected together.
    smallest : tuple of Smallest
        The smallest difference of each part; empty where there is no study yet.
    effort : Effort
        How much was simulated, at least.
    cut : str
        What was simulated less than asked, in words; empty where nothing was.
    """

    request: Request
    cells: tuple[Cell, ...]
    meanings: dict[tuple[str, float], str]
    tests: dict[str, int]
    smallest: tuple[Smallest, ...]
    effort: Effort
    cut: str

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the study's parts."""
        return tuple(power.part for power in self.cells[0].powers)

    def power(self, part: int, participants: int, items: int, effect: float) -> Power:
        """Return what one of the cells says of a part, by its place."""
        return next(
            cell.powers[part]
            for cell in self.cells
            if cell.size.numbers == (participants, items) and cell.powers[part].effect == effect
        )


def plan(request: Request, runner: Runner) -> Plan:
    """Simulate all that is asked for."""
    sizes = {(p, i): request.size(p, i) for i, p in product(request.items, request.participants)}
    asked = [
        Task(
            size=size,
            effect=effect,
            opinions=request.opinions,
            effort=request.effort,
            seed=request.seed,
        )
        for size in sizes.values()
        for effect in request.effects
    ]
    tasks = limit_effort(asked, request.minutes)
    cells = runner.cells(tasks)
    smallest: tuple[Smallest, ...] = ()
    if request.own is not None:
        own_size = request.own
        size = sizes.get(own_size) or request.size(*own_size)
        # Found with at most as much effort as all others.
        effort = min((task.effort for task in tasks), key=lambda effort: effort.quick)
        smallest = _smallest(request, size, cells, effort, replace(runner, show=None))
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
        effort=tasks[0].effort,
        cut=_cut(request, asked, tasks),
    )


def _smallest(
    request: Request, size: Size, cells: Sequence[Cell], effort: Effort, runner: Runner
) -> tuple[Smallest, ...]:
    known = [cell for cell in cells if cell.size.numbers == size.numbers]
    smallest = []
    for number, part in enumerate(size.parts):

        def power_at(effect: float, number: int = number) -> float:
            task = Task(
                size=size,
                effect=effect,
                opinions=request.opinions,
                effort=effort,
                seed=request.seed,
            )
            (cell,) = runner.cells([task])
            return cell.powers[number].power

        powers = {
            cell.powers[number].effect: cell.powers[number].power
            for cell in known
            if cell.powers[number].effect > 0
        }
        effect, reason = smallest_effect(powers or {_FIRST: power_at(_FIRST)}, power_at)
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


def _cut(request: Request, asked: Sequence[Task], tasks: Sequence[Task]) -> str:
    if tasks[0].effort == asked[0].effort:
        return ""
    effort = tasks[0].effort
    long = estimate_minutes(tasks)
    still = f", which still takes about {math.ceil(long)}" if long > 1.2 * request.minutes else ""
    return (
        f"Each power rests on {effort.quick:,} simulated studies instead of "
        f"{request.effort.quick:,}, and on at most {effort.exact} fitted models, to take about "
        f"{request.minutes:g} minutes{still}."
    )


def smallest_effect(
    known: Mapping[float, float], power_at: Callable[[float], float]
) -> tuple[float, str]:
    """Return the smallest difference that is found, and why there is none.

    Between two differences that were simulated, the probit of the power rises evenly.

    Parameters
    ----------
    known : mapping of float to float
        The powers of some differences above 0, by their size in logits.
    power_at : callable
        Simulates the power of another one.
    """
    powers = dict(sorted(known.items()))
    if any(math.isnan(power) for power in powers.values()):
        return math.nan, "there is no test"
    while max(powers.values()) < WANTED:
        larger = 1.5 * max(powers)
        if larger > LARGEST:
            return math.nan, f"not even a difference of {max(powers):.2g} logits is found so often"
        powers[larger] = power_at(larger)
    while min(powers.values()) >= WANTED:
        smaller = min(powers) / 2
        if smaller < SMALLEST:
            return math.nan, f"even a difference of {min(powers):.2g} logits is found so often"
        powers[smaller] = power_at(smaller)
    above = min(effect for effect, power in powers.items() if power >= WANTED)
    below = max(effect for effect in powers if effect < above)
    low, high = (_probit(powers[effect]) for effect in (below, above))
    share = (float(norm.ppf(WANTED)) - low) / (high - low)
    return below + share * (above - below), ""


def _probit(power: float) -> float:
    return float(norm.ppf(min(1 - _SURE, max(_SURE, power))))
