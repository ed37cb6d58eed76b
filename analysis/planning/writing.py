"""Writing a plan: its sentences, its numbers for programs, its table, and its figure."""

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from analysis.planning.plan import TARGET_POWER, Cell, Plan
from analysis.planning.power import Power
from analysis.report.figures.panels import Panel, PanelFigure, draw_sheet
from analysis.report.figures.style import FORMATS, LINE, SOFT, as_file, series_style
from analysis.report.texts import paragraphs
from analysis.report.wording import count, share
from motion.files import replacing, write_frame

_WIDE: Final = 32


def write_plan(plan: Plan, folder: Path) -> tuple[Path, ...]:
    """Write ``power.csv``, and ``power.png``, ``.svg`` and ``.pdf``, into `folder`."""
    write_frame(folder / "power.csv", power_table(plan))
    written = [folder / "power.csv"]
    figure = power_figure(plan)
    for ending in FORMATS:
        path = folder / f"power.{ending}"
        with replacing(path) as draft:
            draft.write_bytes(as_file(figure, ending))
        written.append(path)
    return tuple(written)


def power_table(plan: Plan) -> pd.DataFrame:
    """Return a row for each size, part of the study and effect."""
    table = []
    for cell in plan.cells:
        for power in cell.powers:
            part = {"part": power.part} if any(plan.parts) else {}
            row = {
                "participants": cell.size.participants,
                "recruited": cell.size.recruited,
                "analysed": cell.size.analysed,
                "segments": cell.size.items,
                "trials": cell.size.trials,
                "effect": power.effect,
                "in_answers": plan.meanings[power.part, power.effect],
                "power": round(power.power, 4),
                "error": round(power.error, 4),
                "power_uncorrected": round(power.uncorrected, 4),
                "reason": power.reason,
            }
            table.append(part | row)
    return pd.DataFrame(table)


def power_lines(plan: Plan) -> Iterator[str]:
    """Yield a table of powers, a line for each size, a column for each effect."""
    effects = plan.request.effects
    for number, part in enumerate(plan.parts):
        head = "".join(f"{f'{effect:g} logits':>14}" for effect in effects)
        yield f"{f'{part}, ' if part else ''}participants x segments".ljust(_WIDE) + head
        for items in plan.request.items:
            for participants in plan.request.participants:
                powers = [plan.power(number, participants, items, effect) for effect in effects]
                columns = ["-" if power.reason else with_error(power) for power in powers]
                size = f"{participants} x {items}"
                mark = " (as it stands)" if plan.request.current == (participants, items) else ""
                yield (size + mark).ljust(_WIDE) + "".join(f"{column:>14}" for column in columns)


_DASHES: Final = ("-", "--", "-.", ":")
_HEIGHT: Final = 1.75
"""Height of a panel, in inches."""


def power_figure(plan: Plan) -> Figure:
    """Draw a panel for each part of the study and each effect."""
    panels = {
        f"{f'{part}: ' if part else ''}{effect:g} logits: {plan.meanings[part, effect]}": (
            number,
            effect,
        )
        for number, part in enumerate(plan.parts)
        for effect in plan.request.effects
    }
    per_comparison = " in each comparison" if plan.request.per_comparison else ""

    def draw(panel: Panel, title: str) -> tuple[str, ...]:
        (axes,) = panel.axes
        _panel(axes, plan, *panels[title])
        axes.set_xlabel(f"participants{per_comparison}", fontsize=7.5)
        if panel.is_first:
            axes.set_ylabel("How often a true difference\nis found (± 2 errors)", fontsize=8)
        axes.tick_params(labelleft=panel.is_first, left=panel.is_first)
        return ()

    legend = [
        Line2D([], [], label=count(items, "segment"), **_line_style(place))
        for place, items in enumerate(plan.request.items)
    ]
    panel_figure = PanelFigure(
        titles=[*panels],
        draw=draw,
        height=_HEIGHT,
        columns=min(3, len(plan.request.effects)),
        legend=legend,
    )
    return draw_sheet(panel_figure, list(panels)).figure


def _panel(axes: Axes, plan: Plan, number: int, effect: float) -> None:
    axes.axhline(TARGET_POWER, color=SOFT, linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
    participants = plan.request.participants
    for place, items in enumerate(plan.request.items):
        powers = [plan.power(number, count, items, effect) for count in participants]
        # Two standard errors, within [0, 1].
        below = [min(2 * power.error, power.power) for power in powers]
        above = [min(2 * power.error, 1 - power.power) for power in powers]
        axes.errorbar(
            participants,
            [power.power for power in powers],
            yerr=[below, above],
            elinewidth=0.8,
            **_line_style(place),
        )
    axes.set_ylim(0, 1)
    axes.set_yticks([0, 0.2, 0.4, 0.6, 0.8, 1], ["0", ".2", ".4", ".6", ".8", "1"])
    axes.set_xscale("log")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xticks(participants, [str(count) for count in participants])
    margin = 1.12
    axes.set_xlim(participants[0] / margin, participants[-1] * margin)
    axes.grid(axis="y", color=LINE, linewidth=0.4)
    axes.set_axisbelow(True)


def _line_style(place: int) -> dict[str, Any]:
    colour, marker = series_style(place)
    return {
        "color": colour,
        "marker": marker,
        "markersize": 4,
        "linestyle": _DASHES[place % len(_DASHES)],
        "linewidth": 1.3,
        "clip_on": False,
        "zorder": 3,
    }


LITTLE: Final = 0.08
"""Doubling the participants adds little if it raises the power by less than this."""

SEEN: Final = 0.2
"""Powers below this do not show yet what more participants add."""


def plan_sentences(plan: Plan) -> tuple[str, ...]:
    """Return a plan's sentences, the most important first."""
    by_part = [
        f"{part}: {sentence}" if part else sentence
        for number, part in enumerate(plan.parts)
        for sentence in _of_part(plan, number, part)
    ]
    tested = sorted({count for count in plan.tests.values() if count > 1})
    assumed = paragraphs("plan.assumed", request=plan.request, together=[*map(str, tested)])
    return (*by_part, *assumed, *plan.request.notes)


def with_error(power: Power) -> str:
    """Return a power with its Monte-Carlo standard error, such as .82 ± .02."""
    if power.reason:
        return f"– ({power.reason})"
    return f"{share(power.power)} ± {share(power.error)}"


def _of_part(plan: Plan, number: int, part: str) -> tuple[str, ...]:
    request, cells = plan.request, [(cell, cell.powers[number]) for cell in plan.cells]
    as_it_stands = [(cell, power) for cell, power in cells if cell.size.numbers == request.current]
    per_comparison = " per comparison" if request.per_comparison else ""
    untested: dict[str, dict[str, None]] = {}
    for cell, power in cells:
        if power.reason:
            size = f"{cell.size.participants} x {cell.size.items}"
            untested.setdefault(power.reason, {})[size] = None
    known = [power for _, power in as_it_stands if not power.reason]
    return paragraphs(
        "plan.part",
        request=request,
        people=lambda number: f"{count(number, 'participant')}{per_comparison}",
        with_error=with_error,
        wanted=f"{TARGET_POWER:g}".removeprefix("0"),
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
    )


def _logits(plan: Plan, part: str, effect: float) -> str:
    """Return a difference with what it means in answers."""
    return f"{effect:g} logits ({plan.meanings[part, effect]})"


class _Saturated(NamedTuple):
    """The number of participants beyond which more add little, and what adds more."""

    effect: float
    items: int
    enough: int
    more: int
    before: float
    after: float
    add: tuple[int, float] | None


def _saturated(plan: Plan, number: int) -> Iterator[_Saturated]:
    """Yield where more participants add little, although the power is too low."""
    for effect in plan.request.effects:
        for items in plan.request.items:
            for enough, larger in pairwise(sorted(plan.request.participants)):
                before, after = (plan.power(number, p, items, effect) for p in (enough, larger))
                gain = after.power - before.power
                is_little = gain / math.log2(larger / enough) < LITTLE
                if not (SEEN < after.power < TARGET_POWER and is_little):
                    continue
                others = [
                    (other, power.power)
                    for other in sorted(plan.request.items)
                    for power in (plan.power(number, enough, other, effect),)
                    if other > items and power.power - before.power > max(gain, 2 * power.error)
                ]
                add = others[0] if others else None
                yield _Saturated(effect, items, enough, larger, before.power, after.power, add)
                break


def _cheapest(
    plan: Plan, cells: list[tuple[Cell, Power]], part: str
) -> Iterator[tuple[str, Cell, Power, bool]]:
    """Yield the smallest study that is powerful enough, or the most powerful one, by effect."""
    for effect in filter(None, plan.request.effects):
        tried = [(cell, power) for cell, power in cells if power.effect == effect]
        enough = [(cell, power) for cell, power in tried if power.power >= TARGET_POWER]
        known = [(cell, power) for cell, power in tried if not power.reason]
        if len(tried) < 2 or not (enough or known):
            continue
        if enough:
            cell, power = min(enough, key=lambda pair: pair[0].size.numbers)
        else:
            cell, power = max(known, key=lambda pair: pair[1].power)
        yield _logits(plan, part, effect), cell, power, bool(enough)
