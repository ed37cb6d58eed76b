"""A plan in sentences: what a study finds, what would help it, and what was assumed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Final, NamedTuple

from analysis.planning.grid import Cell
from analysis.planning.plan import WANTED, Plan
from analysis.planning.power import Power
from analysis.report.texts import paragraphs
from analysis.report.wording import count, share

LITTLE: Final = 0.08
"""A doubling that raises the power by less adds little."""

SEEN: Final = 0.2
"""Powers below say nothing yet about what more participants add."""

APART: Final = 0.05
"""Powers that differ by more are worth a sentence."""


def plan_sentences(plan: Plan) -> tuple[str, ...]:
    """Return what a plan says, the most important first."""
    by_part = [
        f"{part}: {sentence}" if part else sentence
        for number, part in enumerate(plan.parts)
        for sentence in _of_part(plan, number, part)
    ]
    tested = sorted({count for count in plan.tests.values() if count > 1})
    assumed = paragraphs("plan.assumed", request=plan.request, together=[*map(str, tested)])
    return (*by_part, *assumed, *plan.request.notes, *([plan.cut] if plan.cut else []))


def with_error(power: Power) -> str:
    """Return a power with its Monte-Carlo standard error, such as .82 ± .02."""
    if power.reason:
        return f"– ({power.reason})"
    return f"{share(power.power)} ± {share(power.error)}"


def _of_part(plan: Plan, number: int, part: str) -> tuple[str, ...]:
    request, cells = plan.request, [(cell, cell.powers[number]) for cell in plan.cells]
    as_it_stands = [(cell, power) for cell, power in cells if cell.size.numbers == request.own]
    each = " per comparison" if request.per_comparison else ""
    untested: dict[str, dict[str, None]] = {}
    for cell, power in cells:
        if power.reason:
            size = f"{cell.size.participants} x {cell.size.items}"
            untested.setdefault(power.reason, {})[size] = None
    known = [power for _, power in as_it_stands if not power.reason]
    return paragraphs(
        "plan.part",
        request=request,
        people=lambda number: f"{count(number, 'participant')}{each}",
        with_error=with_error,
        wanted=f"{WANTED:g}".removeprefix("0"),
        own=as_it_stands[0][0] if as_it_stands else None,
        differences=[
            f"{_logits(plan, part, power.effect)} with power {with_error(power)}"
            for power in known
            if power.effect > 0
        ],
        nothing=[power for power in known if not power.effect],
        untested=untested,
        smallest=[effect for effect in plan.smallest if effect.part == part],
        saturated=[*_saturated(plan, number)][:1],
        cheapest=[*_cheapest(plan, cells, part)],
        alone=_alone(plan, number),
        tests=plan.tests[part],
    )


def _logits(plan: Plan, part: str, effect: float) -> str:
    """Return a difference with what it means in answers."""
    return f"{effect:g} logits ({plan.meanings[part, effect]})"


class _Saturated(NamedTuple):
    """From how many participants on more of them add little, and what adds more."""

    effect: float
    items: int
    enough: int
    more: int
    before: float
    after: float
    add: tuple[int, float] | None


def _saturated(plan: Plan, number: int) -> Iterator[_Saturated]:
    """Give where participants add little although power is wanting."""
    for effect in plan.request.effects:
        for items in plan.request.items:
            for enough, larger in pairwise(sorted(plan.request.participants)):
                before, after = (_power(plan, number, p, items, effect) for p in (enough, larger))
                gain = after.power - before.power
                is_little = gain / math.log2(larger / enough) < LITTLE
                if not (SEEN < after.power < WANTED and is_little):
                    continue
                others = [
                    (other, power.power)
                    for other in sorted(plan.request.items)
                    for power in (_power(plan, number, enough, other, effect),)
                    if other > items and power.power - before.power > max(gain, 2 * power.error)
                ]
                add = others[0] if others else None
                yield _Saturated(effect, items, enough, larger, before.power, after.power, add)
                break


def _cheapest(
    plan: Plan, cells: list[tuple[Cell, Power]], part: str
) -> Iterator[tuple[str, Cell, Power, bool]]:
    """Give the study with the fewest participants that is powerful enough, or the best one."""
    for effect in filter(None, plan.request.effects):
        tried = [(cell, power) for cell, power in cells if power.effect == effect]
        enough = [(cell, power) for cell, power in tried if power.power >= WANTED]
        known = [(cell, power) for cell, power in tried if not power.reason]
        if len(tried) < 2 or not (enough or known):
            continue
        if enough:
            cell, power = min(enough, key=lambda pair: pair[0].size.numbers)
        else:
            cell, power = max(known, key=lambda pair: pair[1].power)
        yield _logits(plan, part, effect), cell, power, bool(enough)


def _alone(plan: Plan, number: int) -> Power | None:
    """Return the power that differs most from that of a difference in one block of tests alone."""
    size = plan.request.own or (plan.request.participants[0], plan.request.items[0])
    powers = [cell.powers[number] for cell in plan.cells if cell.size.numbers == size]
    differing = [power for power in powers if power.power - power.alone > APART]
    return max(differing, key=lambda power: power.power - power.alone, default=None)


def _power(plan: Plan, number: int, participants: int, items: int, effect: float) -> Power:
    cell = plan.cell(participants, items, effect)
    if cell is None:
        raise LookupError(f"{participants} x {items} was not simulated")
    return cell.powers[number]
