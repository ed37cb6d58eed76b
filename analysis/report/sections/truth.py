"""The section that holds a rehearsal's estimates against what its raters were given."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.by_question import question_name
from analysis.report.content import Cell, Section, Table
from analysis.report.headline.words import between, number, number_cell
from analysis.report.subject import Subject
from analysis.results.known_values import KnownValue, found_values
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate

MEASURES: Final = MappingProxyType(
    {
        "win_share": "win share of the first",
        "own_speech": "win share of the own speech",
        "mean_rating": "mean rating",
        "mean_rank": "mean rank",
    }
)


def truth_section(reports: Sequence[TableReport], subject: Subject) -> Section | None:
    """Return how a rehearsal's estimates compare with what its raters were given."""
    pairs = found_values(reports, subject.truth)
    if not pairs:
        return None
    inside = sum(found.covers(known.value) for known, found in pairs)
    with_interval = sum(found.has_interval for _, found in pairs)
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=(
            f"Simulated raters prefer by rule, so the true values are known. {inside} of "
            f"{wording.count(with_interval, 'interval')} contain theirs. In the long run about "
            f"{LEVEL:.0%} should, so that one or more of {with_interval} may miss it in up to "
            f"{100 * (1 - LEVEL**with_interval):.0f} of 100 rehearsals.",
        ),
        tables=(
            Table(
                caption="What the simulated raters were given to prefer, and its estimate after "
                "exclusions. The interval speaks of all segments such as these; which ones were "
                "drawn moves the estimate towards the last column.",
                header=(
                    *("question", "of", "number", "truth", "estimate"),
                    *(f"{LEVEL:.0%} interval", "truth is", "truth for these segments"),
                ),
                rows=tuple(_row(known, found) for known, found in pairs),
                text_columns=3,
                name="truth",
            ),
        ),
    )


def _row(known: KnownValue, found: Estimate) -> tuple[Cell, ...]:
    where = "outside" if found.has_interval else "no interval"
    ends = found.reason or "none"
    if found.has_interval:
        ends = between(number(found.low), number(found.high))
    return (
        Cell(text=question_name(known.part, known.question)),
        Cell(text=wording.name(known.about)),
        Cell(text=MEASURES[known.measure]),
        number_cell(known.value),
        number_cell(found.estimate),
        Cell(text=ends),
        Cell(text="inside" if found.covers(known.value) else where),
        number_cell(known.on_these_segments),
    )
