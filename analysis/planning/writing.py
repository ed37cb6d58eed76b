"""Writing a plan: its numbers for programs, its table, its figure and its words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import pandas as pd

from analysis.planning.figure import FORMATS, power_figure
from analysis.planning.plan import Plan
from analysis.planning.words import sentences, with_error
from analysis.report.writing import write_frame
from analysis.results.report import as_json
from motion.files import replacing, write_text

CELLS: Final = ".simulated"
"""Folder beside them that keeps what was simulated."""

_WIDE: Final = 32


def write_plan(plan: Plan, folder: Path) -> tuple[Path, ...]:
    """Write ``plan.json``, ``power.csv`` and ``power.png``, ``.svg`` and ``.pdf`` into `folder`."""
    write_text(folder / "plan.json", as_json(document(plan)))
    write_frame(folder / "power.csv", rows(plan))
    written = [folder / "plan.json", folder / "power.csv"]
    figure = power_figure(plan)
    for ending, made in FORMATS.items():
        path = folder / f"power.{ending}"
        with replacing(path) as draft:
            draft.write_bytes(made(figure))
        written.append(path)
    return tuple(written)


def document(plan: Plan) -> dict[str, Any]:
    """Return what ``plan.json`` holds."""
    request = plan.request
    return {
        "title": request.title,
        "protocol": request.protocol,
        "as_it_stands": None
        if request.own is None
        else {"participants": request.own[0], "segments": request.own[1]},
        "per_comparison": request.per_comparison,
        "assumed": {
            **asdict(request.opinions),
            "excluded": request.excluded,
            "source": request.source,
        },
        "tests_corrected_together": plan.tests,
        "pay": request.pay,
        "seed": request.seed,
        "effort": asdict(plan.effort),
        "sentences": sentences(plan),
        "smallest": [asdict(one) for one in plan.smallest],
        "powers": rows(plan).to_dict("records"),
    }


def rows(plan: Plan) -> pd.DataFrame:
    """Return a row for each size, part of the study and effect."""
    found = []
    for cell in plan.cells:
        for power in cell.powers:
            row: dict[str, object] = {"part": power.part} if any(plan.parts) else {}
            row |= {
                "participants": cell.participants,
                "recruited": cell.recruited,
                "analysed": cell.analysed,
                "segments": cell.items,
                "trials": cell.trials,
                "effect": power.effect,
                "in_answers": plan.meanings[power.part, power.effect],
                "power": round(power.power, 4),
                "error": round(power.error, 4),
                "power_if_alone": round(power.alone, 4),
                "power_uncorrected": round(power.uncorrected, 4),
                "studies": power.studies,
                "modelled": power.modelled,
                "reason": power.reason,
            }
            if plan.request.pay is not None:
                row["cost"] = round(cell.recruited * plan.request.pay, 2)
            found.append(row)
    return pd.DataFrame(found)


def lines(plan: Plan) -> Iterator[str]:
    """Yield a table of powers, a line for each size, a column for each effect."""
    effects = plan.request.effects
    for number, part in enumerate(plan.parts):
        head = "".join(f"{f'{effect:g} logits':>14}" for effect in effects)
        yield f"{f'{part}, ' if part else ''}participants x segments".ljust(_WIDE) + head
        for items in plan.request.items:
            for participants in plan.request.participants:
                cells = [plan.cell(participants, items, effect) for effect in effects]
                powers = [
                    with_error(cell.powers[number])
                    if cell is not None and not cell.powers[number].reason
                    else "-"
                    for cell in cells
                ]
                size = f"{participants} x {items}"
                own = " (as it stands)" if plan.request.own == (participants, items) else ""
                yield (size + own).ljust(_WIDE) + "".join(f"{one:>14}" for one in powers)
