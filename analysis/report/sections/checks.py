"""Two checks of the estimates: without exclusions, and against what a rehearsal's raters prefer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.content import Cell, Section, Table, count_cell, counted, number_cell, table_of
from analysis.report.sections.preference_rows import reference_of
from analysis.report.subject import Subject
from analysis.report.wording import INTERVAL, interval, number, question_name
from analysis.results.headline import Sensitivity
from analysis.results.known_values import KnownValue, found_values
from analysis.results.pairwise import PairwiseResults
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate

_MEASURES = {
    "pairwise": "win share of the first",
    "mismatch": "share of preferences for its own speech",
    "rating": "mean rating",
    "ranking": "mean rank (1 is best)",
}


def sensitivity_section(report: TableReport, subject: Subject) -> Section | None:
    """Return the headline numbers with and without exclusions; None where nobody is left out."""
    if not report.sensitivity:
        return None
    shown = _seen_from(_reference(report, subject), report.sensitivity)
    is_planned = all(one.is_as_planned for one in shown)
    return Section(
        anchor="sensitivity",
        heading="With and without exclusions",
        paragraphs=(
            "The same numbers of those who are analysed, and of everybody who answered. Where the "
            "two differ in what they say, the exclusions decide the result.",
            *(
                ()
                if is_planned
                else (
                    "As planned are those whom the rules keep that were settled beforehand; the "
                    "others, which came afterwards, are exploratory.",
                )
            ),
        ),
        tables=(_table(report.protocol, shown, is_planned),),
    )


def _reference(report: TableReport, subject: Subject) -> str | None:
    """Return the condition that the headline sees every pair from, if there is one."""
    if not isinstance(report.results, PairwiseResults) or not report.results.comparisons:
        return None
    return reference_of(report.results.comparisons, subject.reference)


def _seen_from(reference: str | None, found: Sequence[Sensitivity]) -> tuple[Sensitivity, ...]:
    """Return the numbers with the reference first, as the headline has them."""
    return tuple(
        _turned(one) if reference is not None and one.conditions[1:] == (reference,) else one
        for one in found
    )


def _turned(one: Sensitivity) -> Sensitivity:
    return replace(
        one,
        conditions=one.conditions[::-1],
        analysed=one.analysed.turned(),
        as_planned=one.as_planned.turned(),
        everyone=one.everyone.turned(),
    )


def _table(protocol: str, shown: Sequence[Sensitivity], is_planned: bool) -> Table:
    groups = ("analysed", *(() if is_planned else ("as planned",)), "nobody excluded")
    measure = _MEASURES[protocol]
    return table_of(
        shown,
        ("question", lambda one: question_name(one.set or "", one.question)),
        ("condition" if len(shown[0].conditions) == 1 else "pair", _of),
        *(
            column
            for place in range(len(groups))
            for column in (
                ("participants", partial(_people, is_planned, place)),
                (measure, partial(_number, is_planned, place)),
            )
        ),
        caption=f"{wording.heading(measure)}, with its 95% interval, clustered by participant "
        "and segment.",
        groups=(("", 2), *((group, 2) for group in groups)),
        notes=dict.fromkeys(
            f"{_of(one)}, {question_name(one.set or '', one.question)}: {number.reason}."
            for one in shown
            for number in _shown(one, is_planned)
            if number.reason
        ),
        name="sensitivity_table",
        data="sensitivity.csv",
    )


def _shown(one: Sensitivity, is_planned: bool) -> tuple[Estimate, ...]:
    if is_planned:
        return one.analysed, one.everyone
    return one.analysed, one.as_planned, one.everyone


def _of(one: Sensitivity) -> str:
    return " – ".join(map(wording.condition, one.conditions))


def _people(is_planned: bool, place: int, one: Sensitivity) -> Cell:
    return count_cell(_shown(one, is_planned)[place].participants)


def _number(is_planned: bool, place: int, one: Sensitivity) -> Cell:
    words = wording.share if one.measure in ("win_share", "own_speech") else number
    found = _shown(one, is_planned)[place]
    text = f"{words(found.estimate)}{wording.NO_BREAK}{interval(found, words)}"
    return counted(found.estimate, text.rstrip(wording.NO_BREAK))


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
                ("of", lambda pair: wording.condition(pair[0].about)),
                ("number", lambda pair: MEASURES[pair[0].measure]),
                ("truth", lambda pair: number_cell(pair[0].value)),
                ("estimate", lambda pair: number_cell(pair[1].estimate)),
                (INTERVAL, lambda pair: interval(pair[1], number) or pair[1].reason or "none"),
                ("truth is", lambda pair: _truth_place(*pair)),
                (
                    "truth for these segments",
                    lambda pair: number_cell(pair[0].on_these_segments),
                ),
                caption="The true values of the simulated raters, and their estimates after "
                "exclusions. The interval speaks of all segments such as these; which ones were "
                "drawn moves the estimate towards the last column.",
                name="truth",
            ),
        ),
    )


def _truth_place(known: KnownValue, found: Estimate) -> str:
    if found.covers(known.value):
        return "inside"
    return "outside" if found.has_interval else "no interval"
