"""The section that sets automatic metrics against what people preferred."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from analysis.report import wording
from analysis.report.content import Picture, Section, Table
from analysis.report.figures.dots import MOST, Dot, agreement_pictures, dot_of, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.sections.metric import PAPER_OF, PAPER_TABLES, is_detail
from analysis.report.sections.metric_table import ARROWS
from analysis.report.subject import Subject
from analysis.report.texts import about, paragraphs, sentence, table
from analysis.report.wording import between, question_name
from analysis.results.against_people import AgainstPeople, MetricAgainstPeople
from analysis.results.rank_correlations import (
    FEWEST_FOR_INTERVAL,
    SamplingRange,
)
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import Interval
from motion.errors import listed


@dataclass(frozen=True, kw_only=True)
class _Question:
    """What was found about one question, without metrics that have no score or are details."""

    set: str
    question: str
    found: AgainstPeople
    metrics: tuple[MetricAgainstPeople, ...]

    @property
    def name(self) -> str:
        """Question, and set before it where there are any."""
        return question_name(self.set, self.question)


_UPRIGHT: Final = {
    "pairwise": "strength (logits)",
    "rating": "mean rating",
    "ranking": "minus the mean rank",
    "mismatch": "win share of own speech",
}
_MOST_ROWS: Final = 24
"""Metrics that one sheet of the forest has."""

_CORRELATION: Final = Scale(
    limits=(-1.05, 1.05),
    ticks={-1: "−1", -0.5: "−.5", 0: "0", 0.5: ".5", 1: "1"},
    ends=("disagrees", "agrees"),
    line=0.0,
)


def against_people_section(report: TableReport, subject: Subject) -> Section | None:
    """Return how metrics and preferences agree; None where nothing was measured or answered."""
    asked = [
        _Question(
            set=of,
            question=question,
            found=one,
            metrics=tuple(
                metric
                for metric in one.metrics
                if metric.conditions and not is_detail(metric.metric, report.protocol)
            ),
        )
        for of, question, one in report.metrics_against_people.rows()
    ]
    if not asked:
        return None
    heading = "Do the metrics agree with people?"
    measured = [one for one in asked if one.metrics]
    if not measured:
        reasons = dict.fromkeys(one.found.reason for one in asked if one.found.reason)
        said = paragraphs("against_people.nothing", reasons=[*reasons])
        return Section(anchor="against-people", heading=heading, paragraphs=said)
    ranges = {
        one.found.conditions: one.found.sampling_range
        for one in measured
        if one.found.sampling_range
    }
    return Section(
        anchor="against-people",
        heading=heading,
        paragraphs=paragraphs(
            "against_people.section",
            ranges=[how_little(found) for found in ranges.values()],
            decided=[
                _decided("over conditions", measured, "kendall"),
                _decided("within conditions", measured, "within"),
            ],
            protocol=report.protocol,
        ),
        pictures=(*_forests(measured, subject), *_scatters(measured, report, subject)),
        tables=(_table(measured, report.protocol),),
    )


def how_little(found: SamplingRange) -> str:
    """Return in a sentence how little so many conditions can say."""
    return sentence("against_people.how_little", found=found, correlation=_correlation)


def _decided(where: str, asked: Sequence[_Question], kind: str) -> tuple[str, int, list[str]]:
    """Return where, how many intervals there are, and which of them leave out zero."""
    found = [(f"{m.metric} on {one.name}", getattr(m, kind)) for one in asked for m in one.metrics]
    known = [(name, number) for name, number in found if not math.isnan(number.low)]
    clear = [
        f"{name} ({_correlation_words(number)})"
        for name, number in known
        if number.low > 0 or number.high < 0
    ]
    return where, len(known), clear


def _scatters(
    asked: Sequence[_Question], report: TableReport, subject: Subject
) -> Iterator[Picture]:
    own = [column.metric for column in PAPER_TABLES[PAPER_OF[report.protocol]]]
    for number, one in enumerate(asked, start=1):
        drawn = [
            metric
            for metric in one.metrics
            if any(not math.isnan(place.preference) for place in metric.places)
        ]
        if not drawn or one.found.conditions < FEWEST_FOR_INTERVAL:
            continue
        drawn.sort(key=lambda metric: metric.metric not in own)
        names = [place.condition for metric in drawn for place in metric.places]
        order = [name for name in subject.conditions if name in names]
        yield from agreement_pictures(
            drawn[:MOST],
            list(dict.fromkeys([*order, *names])),
            _UPRIGHT[report.protocol],
            about(
                "metrics-against-people",
                end=f"-{number}",
                mark=subject.mark,
                name=one.name,
                preference=one.found.preference,
                people=subject.people,
                shown=MOST,
                all=len(drawn),
            ),
        )


def _forests(asked: Sequence[_Question], subject: Subject) -> Iterator[Picture]:
    for number, of in enumerate(dict.fromkeys(one.set for one in asked), start=1):
        questions = {one.question: one.metrics for one in asked if one.set == of}
        found = {
            (question, metric.metric): metric
            for question, metrics in questions.items()
            for metric in metrics
        }
        if all(math.isnan(one.low) for m in found.values() for one in (m.kendall, m.within)):
            continue
        where = f", set {wording.name(of)}" if of else ""
        names = list(dict.fromkeys(metric for _, metric in found))
        sheets = -(-len(names) // _MOST_ROWS)
        for sheet in range(sheets):
            start, end = (len(names) * (sheet + k) // sheets for k in (0, 1))
            rows = [[found.get((q, name)) for q in questions] for name in names[start:end]]
            suffix = (f"-{number}" if of else "") + (f"-{sheet + 1}" if sheets > 1 else "")
            told = about("metric-correlations", end=suffix, mark=subject.mark, where=where)
            yield from dot_pictures(
                {
                    "Over conditions: Kendall's τ-b": [
                        [_dot(metric.kendall if metric else None) for metric in row] for row in rows
                    ],
                    "Within conditions: r": [
                        [_dot(metric.within if metric else None) for metric in row] for row in rows
                    ],
                },
                [Row(name) for name in names[start:end]],
                _CORRELATION,
                told,
                series=[wording.heading(question) for question in questions],
            )


def _dot(found: Interval | None) -> Dot:
    made = dot_of(found, _correlation, missing="–")
    return replace(made, words="", descriptive=math.isnan(made.low))


def _correlation_words(found: Interval) -> str:
    """Return a correlation with its interval where it has one, '.52 [.11, .79]'."""
    inside = "" if math.isnan(found.low) else f" {_interval_words(found)}"
    return f"{_correlation(found.estimate)}{inside}"


def _interval_words(found: Interval) -> str:
    return between(_correlation(found.low), _correlation(found.high))


def _correlation(value: float) -> str:
    """Return a correlation as a share, '1' and '−1' without decimals."""
    if not math.isnan(value) and abs(value) > 0.995:
        return "1" if value > 0 else "−1"
    return wording.share(value)


def _table(asked: Sequence[_Question], protocol: str) -> Table:
    rows = [(one, metric) for one in asked for metric in one.metrics]
    why = [k.reason for _, m in rows for k in (m.kendall, m.spearman, m.within) if k.reason]
    reasons = {reason: number for number, reason in enumerate(dict.fromkeys(why), start=1)}

    def ends(found: Interval) -> str:
        if not math.isnan(found.estimate) and not math.isnan(found.low):
            return _interval_words(found)
        number = f"({reasons[found.reason]})" if found.reason else ""
        return f"–{wording.NO_BREAK}{number}"

    made = table(
        "metrics-against-people",
        rows,
        arrows=ARROWS,
        correlation=_correlation,
        ends=ends,
        protocol=protocol,
    )
    notes = paragraphs(
        "against_people.notes",
        reasons=reasons,
        left_out=_left_out(asked),
        one=asked[0].found,
        most=max(metric.kendall.degenerate for _, metric in rows),
    )
    return replace(made, notes=notes)


def _left_out(asked: Sequence[_Question]) -> dict[tuple[str, str], list[str]]:
    """Return the metrics by the conditions that they are not correlated over, and why."""
    about: dict[tuple[str, str], list[str]] = {}
    for metric in (metric for one in asked for metric in one.metrics):
        for reason in dict.fromkeys(metric.left_out.values()):
            names = [name for name, why in metric.left_out.items() if why == reason]
            key = listed([wording.condition(name) for name in names]), reason
            if metric.metric not in about.setdefault(key, []):
                about[key].append(metric.metric)
    return about
