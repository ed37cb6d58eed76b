"""The section that holds a rehearsal's estimates against what its raters were given."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.content import Section, table_of
from analysis.report.headline.words import INTERVAL, between, number, number_cell, question_name
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
            table_of(
                pairs,
                ("question", lambda pair: question_name(pair[0].part, pair[0].question)),
                ("of", lambda pair: wording.name(pair[0].about)),
                ("number", lambda pair: MEASURES[pair[0].measure]),
                ("truth", lambda pair: number_cell(pair[0].value)),
                ("estimate", lambda pair: number_cell(pair[1].estimate)),
                (INTERVAL, lambda pair: _interval(pair[1])),
                ("truth is", lambda pair: _where(*pair)),
                (
                    "truth for these segments",
                    lambda pair: number_cell(pair[0].on_these_segments),
                ),
                caption="What the simulated raters were given to prefer, and its estimate after "
                "exclusions. The interval speaks of all segments such as these; which ones were "
                "drawn moves the estimate towards the last column.",
                name="truth",
            ),
        ),
    )


def _interval(found: Estimate) -> str:
    if not found.has_interval:
        return found.reason or "none"
    return between(number(found.low), number(found.high))


def _where(known: KnownValue, found: Estimate) -> str:
    if found.covers(known.value):
        return "inside"
    return "outside" if found.has_interval else "no interval"
