"""A plan in sentences: what a study finds, what would help it, and what was assumed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

from analysis.planning.grid import Cell
from analysis.planning.plan import WANTED, Plan
from analysis.planning.power import Power
from analysis.report.wording import share
from motion.errors import listed

LITTLE: Final = 0.08
"""A doubling that raises the power by less adds little."""

SEEN: Final = 0.2
"""Powers below say nothing yet about what more participants add."""

APART: Final = 0.05
"""Powers that differ by more are worth a sentence."""


def sentences(plan: Plan) -> tuple[str, ...]:
    """Return what a plan says, the most important first."""
    found: list[str] = []
    for number, part in enumerate(plan.parts):
        own = [
            *_as_it_stands(plan, number),
            *_untested(plan, number),
            *_smallest(plan, part),
            *_saturation(plan, number),
            *_cheapest(plan, number),
            *_alone(plan, number),
        ]
        where = f"{part}: " if part else ""
        found += [f"{where}{sentence}" for sentence in own]
    return (*found, *_assumed(plan), *plan.request.notes, *([plan.cut] if plan.cut else []))


def with_error(power: Power) -> str:
    """Return a power with its Monte-Carlo standard error, such as .82 ± .02."""
    if power.reason:
        return f"– ({power.reason})"
    return f"{share(power.power)} ± {share(power.error)}"


def people(plan: Plan, count: int) -> str:
    """Return so many participants, and whether each comparison has them."""
    each = " per comparison" if plan.request.per_comparison else ""
    return f"{count} participant{'' if count == 1 else 's'}{each}"


def segments(count: int) -> str:
    """Return so many segments."""
    return f"{count} segment{'' if count == 1 else 's'}"


def logits(plan: Plan, part: str, effect: float) -> str:
    """Return a difference with what it means in answers."""
    return f"{effect:g} logits ({plan.meanings[part, effect]})"


def _wanted() -> str:
    return f"{WANTED:g}".removeprefix("0")


def _of(plan: Plan, number: int) -> Iterator[tuple[Cell, Power]]:
    for cell in plan.cells:
        yield cell, cell.powers[number]


def _as_it_stands(plan: Plan, number: int) -> Iterator[str]:
    if plan.request.own is None:
        return
    own = [
        (cell, power) for cell, power in _of(plan, number) if cell.size.numbers == plan.request.own
    ]
    if not own:
        return
    cell, part = own[0][0], plan.parts[number]
    left = (
        f" ({cell.size.analysed} of them analysed)"
        if cell.size.analysed < cell.size.participants
        else ""
    )
    found = [
        f"{logits(plan, part, power.effect)} with power {with_error(power)}"
        for _, power in own
        if power.effect > 0 and not power.reason
    ]
    size = f"with {people(plan, cell.size.participants)}{left} and {segments(cell.size.items)}"
    if found:
        yield (
            f"As it stands, {size}, the study finds a difference of {listed(found)}."
            f"{_cost(plan, cell)}"
        )
    for _, power in own:
        if not power.effect and not power.reason:
            yield (
                f"Where there is no difference, {with_error(power)} of the study's tests find one "
                "all the same."
            )


def _untested(plan: Plan, number: int) -> Iterator[str]:
    """Say why there is no power of some sizes."""
    reasons: dict[str, list[str]] = {}
    for cell, power in _of(plan, number):
        if power.reason:
            size = f"{cell.size.participants} x {cell.size.items}"
            sizes = reasons.setdefault(power.reason, [])
            if size not in sizes:
                sizes.append(size)
    for reason, sizes in reasons.items():
        yield f"Nothing can be found with {listed(sizes)}: {reason}."


def _smallest(plan: Plan, part: str) -> Iterator[str]:
    for one in plan.smallest:
        if one.part != part:
            continue
        if one.reason:
            yield f"At power {_wanted()}, {one.reason}."
        else:
            yield (
                f"The smallest difference that it finds with power {_wanted()} is "
                f"{one.effect:.2f} logits ({one.in_answers})."
            )


def _saturation(plan: Plan, number: int) -> Iterator[str]:
    """Say from how many participants on more of them add little, and what adds more."""
    for effect in plan.request.effects:
        for place, items in enumerate(plan.request.items):
            powers = [(p, _power(plan, number, p, items, effect)) for p in _ascending(plan)]
            found = _first_little(powers)
            if found is None:
                continue
            enough, more, gain = found
            yield (
                f"With {segments(items)}, more than {people(plan, enough)} add little: {more} "
                f"raise the power for {effect:g} logits from "
                f"{share(_power(plan, number, enough, items, effect).power)} to "
                f"{share(_power(plan, number, more, items, effect).power)} only"
                f"{_more_segments(plan, number, enough, place, effect, gain)}."
            )
            return


def _more_segments(
    plan: Plan, number: int, participants: int, place: int, effect: float, gain: float
) -> str:
    """Return that segments should be added, where that was simulated and helps more."""
    here = _power(plan, number, participants, plan.request.items[place], effect).power
    for items in sorted(plan.request.items):
        if items <= plan.request.items[place]:
            continue
        there = _power(plan, number, participants, items, effect)
        if there.power - here > max(gain, 2 * there.error):
            return f"; {segments(items)} raise it to {share(there.power)}: add segments"
    return ""


def _first_little(powers: Sequence[tuple[int, Power]]) -> tuple[int, int, float] | None:
    """Return from where to where participants add little although power is wanting."""
    for (fewer, before), (more, after) in pairwise(powers):
        gain = after.power - before.power
        doublings = math.log2(more / fewer)
        seen = after.power > SEEN
        if seen and after.power < WANTED and gain / doublings < LITTLE:
            return fewer, more, gain
    return None


def _cheapest(plan: Plan, number: int) -> Iterator[str]:
    """Name the study with the fewest participants that is powerful enough, effect by effect."""
    part = plan.parts[number]
    for effect in plan.request.effects:
        if not effect:
            continue
        cells = [(cell, power) for cell, power in _of(plan, number) if power.effect == effect]
        enough = [(cell, power) for cell, power in cells if power.power >= WANTED]
        if len(cells) < 2:
            continue
        if not enough:
            known = [one for one in cells if not one[1].reason]
            if not known:
                continue
            cell, power = max(known, key=lambda one: one[1].power)
            yield (
                f"None of these studies finds {logits(plan, part, effect)} with power "
                f"{_wanted()}; the best, with {people(plan, cell.size.participants)} and "
                f"{segments(cell.size.items)}, has {with_error(power)}."
            )
            continue
        cell, power = min(enough, key=lambda one: one[0].size.numbers)
        yield (
            f"The fewest participants that find {logits(plan, part, effect)} with power "
            f"{_wanted()} are {people(plan, cell.size.participants)} with "
            f"{segments(cell.size.items)} ({with_error(power)}).{_cost(plan, cell)}"
        )


def _alone(plan: Plan, number: int) -> Iterator[str]:
    """Say what a difference in one block of tests alone would do to the power."""
    tests = plan.tests[plan.parts[number]]
    cells = [cell for cell in plan.cells if _is_own(plan, cell)]
    apart = [
        cell.powers[number]
        for cell in cells
        if cell.powers[number].power - cell.powers[number].alone > APART
    ]
    if apart:
        power = max(apart, key=lambda one: one.power - one.alone)
        yield (
            f"These powers hold where all of the {tests} corrected tests have the difference; were "
            f"it in one comparison and question alone, {power.effect:g} logits would be found with "
            f"power {share(power.alone)} instead of {share(power.power)}."
        )


def _is_own(plan: Plan, cell: Cell) -> bool:
    size = plan.request.own or (plan.request.participants[0], plan.request.items[0])
    return cell.size.numbers == size


def _assumed(plan: Plan) -> Iterator[str]:
    request = plan.request
    yield (
        f"{request.source}: the difference of two conditions varies by "
        f"{request.opinions.participant_sd:.2g} logits between participants and by "
        f"{request.opinions.item_sd:.2g} between segments; {request.excluded:.0%} of the "
        "participants are excluded."
    )
    tested = {count for count in plan.tests.values() if count > 1}
    together = f" {listed([str(count) for count in sorted(tested)])} tests are corrected together."
    yield f"± is one Monte-Carlo standard error.{together if tested else ''}"


def _cost(plan: Plan, cell: Cell) -> str:
    whole = (
        f" {cell.size.recruited} participants in all"
        if cell.size.recruited != cell.size.participants
        else ""
    )
    if plan.request.pay is None:
        return f"{whole}." if whole else ""
    cost = f"{cell.size.recruited * plan.request.pay:,.2f}"
    if whole:
        return f"{whole} cost {cost}."
    return f" That costs {cost}."


def _power(plan: Plan, number: int, participants: int, items: int, effect: float) -> Power:
    cell = plan.cell(participants, items, effect)
    if cell is None:
        raise LookupError(f"{participants} x {items} was not simulated")
    return cell.powers[number]


def _ascending(plan: Plan) -> list[int]:
    return sorted(plan.request.participants)
