"""The section on looks at results before the answers that are reported."""

from __future__ import annotations

import math
from typing import Final

from analysis.report.content import Section, Table, table_of
from analysis.report.headline.words import count_cell
from analysis.results.looks import LooksBefore
from analysis.results.report import TableReport
from motion.listing import listed

MOST: Final = 100
"""Rows of the table; ``results.json`` has all."""

MOST_NUMBERS: Final = 5
"""Numbers of participants that a sentence names."""

_WAYS: Final = {"page": "researchers' page", "report": "report", "export": "export"}


def looks_section(report: TableReport) -> Section | None:
    """Return what is logged of looks; None where there were none."""
    found = report.looks
    if not found.count:
        return None
    return Section(
        anchor="looks",
        heading="Looks at results before the end",
        paragraphs=(
            f"{_counted(found)} Whoever may stop, extend or change a study because of what a look "
            "shows finds what is not there more often than a p value says: p values and intervals "
            "here take the number of participants for settled beforehand.",
            *_rate(found),
        ),
        tables=(_table(found),),
    )


def looks_sentence(report: TableReport) -> str:
    """Return in one sentence that there were looks; '' where there were none."""
    return (
        f"{_counted(report.looks)} The p values and intervals do not allow for that."
        if report.looks.count
        else ""
    )


def _counted(found: LooksBefore) -> str:
    numbers = [str(number) for number in found.finished]
    if len(numbers) > MOST_NUMBERS:
        at = f"{len(numbers)} numbers of finished participants from {numbers[0]} to {numbers[-1]}"
    else:
        noun = "participant" if numbers == ["1"] else "participants"
        at = f"{listed(numbers)} finished {noun}"
    times = "once" if found.count == 1 else f"{found.count} times"
    return f"Results were looked at {times} before these answers were complete, at {at}."


def _rate(found: LooksBefore) -> tuple[str, ...]:
    if math.isnan(found.false_positive_rate):
        return (f"How much likelier cannot be told: {found.reason}.",)
    return (
        "A study that ends at the first of these looks, or of the answers reported here, that "
        f"shows p < {found.level:g} finds what is not there in "
        f"{100 * found.false_positive_rate:.1f} % of cases instead of {100 * found.level:g} %, "
        "for a single test of a normal mean (Armitage, McPherson and Rowe 1969). Where looks could "
        "change nothing, they did no harm; the reasons below are what was said at the time.",
    )


def _table(found: LooksBefore) -> Table:
    shown = found.looks[-MOST:]
    notes = ["Days in UTC. Looks in a row that differ in nothing are one row."]
    if len(shown) < len(found.looks):
        notes.append(f"The last {MOST} rows of {len(found.looks)}; results.json has all.")
    return table_of(
        shown,
        ("Day", lambda look: look.day),
        ("Who", lambda look: look.by),
        ("Where", lambda look: _WAYS.get(look.way, look.way)),
        ("Why", lambda look: look.reason or "not said"),
        ("Finished", lambda look: count_cell(look.finished)),
        ("Planned", lambda look: count_cell(look.planned)),
        ("Times", lambda look: count_cell(look.times)),
        caption="Looks at results before the answers that are reported: who, why, and how many "
        "participants had finished.",
        notes=notes,
        name="looks",
    )
