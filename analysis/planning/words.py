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


def sentences(plan: Plan) -> tuple[str, ...]:
    """Return what a plan says, the most important first."""
    found = [
        f"{part}: {sentence}" if part else sentence
        for number, part in enumerate(plan.parts)
        for sentence in _of_part(plan, number, part)
    ]
    tested = sorted({count for count in plan.tests.values() if count > 1})
    assumed = paragraphs("plan.assumed", request=plan.request, together=[*map(str, tested)])
    return (*found, *assumed, *plan.request.notes, *([plan.cut] if plan.cut else []))


def with_error(power: Power) -> str:
    """Return a power with its Monte-Carlo standard error, such as .82 ± .02."""
    if power.reason:
        return f"– ({power.reason})"
    return f"{share(power.power)} ± {share(power.error)}"


def _of_part(plan: Plan, number: int, part: str) -> tuple[str, ...]:
    request, cells = plan.request, [(cell, cell.powers[number]) for cell in plan.cells]
    own = [(cell, power) for cell, power in cells if cell.size.numbers == request.own]
    each = " per comparison" if request.per_comparison else ""
    untested: dict[str, dict[str, None]] = {}
    for cell, power in cells:
        if power.reason:
            size = f"{cell.size.participants} x {cell.size.items}"
            untested.setdefault(power.reason, {})[size] = None
    known = [power for _, power in own if not power.reason]
    return paragraphs(
        "plan.part",
        request=request,
        people=lambda number: f"{count(number, 'participant')}{each}",
        with_error=with_error,
        wanted=f"{WANTED:g}".removeprefix("0"),
        own=own[0][0] if own else None,
        differences=[
            f"{_logits(plan, part, power.effect)} with power {with_error(power)}"
            for power in known
            if power.effect > 0
        ],
        nothing=[power for power in known if not power.effect],
        untested=untested,
        smallest=[one for one in plan.smallest if one.part == part],
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
            for enough, more in pairwise(sorted(plan.request.participants)):
                before, after = (_power(plan, number, p, items, effect) for p in (enough, more))
                gain = after.power - before.power
                is_little = gain / math.log2(more / enough) < LITTLE
                if not (SEEN < after.power < WANTED and is_little):
                    continue
                others = [
                    (other, there.power)
                    for other in sorted(plan.request.items)
                    for there in (_power(plan, number, enough, other, effect),)
                    if other > items and there.power - before.power > max(gain, 2 * there.error)
                ]
                add = others[0] if others else None
                yield _Saturated(effect, items, enough, more, before.power, after.power, add)
                break


def _cheapest(
    plan: Plan, cells: list[tuple[Cell, Power]], part: str
) -> Iterator[tuple[str, Cell, Power, bool]]:
    """Give the study with the fewest participants that is powerful enough, or the best one."""
    for effect in filter(None, plan.request.effects):
        own = [(cell, power) for cell, power in cells if power.effect == effect]
        enough = [(cell, power) for cell, power in own if power.power >= WANTED]
        known = [(cell, power) for cell, power in own if not power.reason]
        if len(own) < 2 or not (enough or known):
            continue
        if enough:
            cell, power = min(enough, key=lambda one: one[0].size.numbers)
        else:
            cell, power = max(known, key=lambda one: one[1].power)
        yield _logits(plan, part, effect), cell, power, bool(enough)


def _alone(plan: Plan, number: int) -> Power | None:
    """Return the power that differs most from that of a difference in one block of tests alone."""
    size = plan.request.own or (plan.request.participants[0], plan.request.items[0])
    own = [cell.powers[number] for cell in plan.cells if cell.size.numbers == size]
    apart = [power for power in own if power.power - power.alone > APART]
    return max(apart, key=lambda one: one.power - one.alone, default=None)


def _power(plan: Plan, number: int, participants: int, items: int, effect: float) -> Power:
    cell = plan.cell(participants, items, effect)
    if cell is None:
        raise LookupError(f"{participants} x {items} was not simulated")
    return cell.powers[number]
