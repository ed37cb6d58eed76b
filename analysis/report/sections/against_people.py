"""The section that sets automatic metrics against what people preferred."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from analysis.report import wording
from analysis.report.content import (
    Cell,
    Picture,
    Section,
    Table,
    count_cell,
    table_of,
)
from analysis.report.figures.dots import MOST, Dot, agreement_pictures, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.figures.svg import About
from analysis.report.sections.metric import PAPER_OF, PAPER_TABLES, is_detail
from analysis.report.sections.metric_table import ARROWS
from analysis.report.subject import Subject
from analysis.report.wording import between, question_name
from analysis.results.against_people import AgainstPeople, MetricAgainstPeople
from analysis.results.clip_correlations import WithinCorrelation
from analysis.results.rank_correlations import (
    FEWEST_FOR_INTERVAL,
    RankCorrelation,
    SamplingRange,
)
from analysis.results.report import TableReport
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
_READING: Final = tuple(
    "Over conditions, a correlation asks whether the metric puts conditions in the order in which "
    "people do; within conditions, whether it singles out the clips that people like "
    f"({how}). Above zero, the metric agrees with people in its own direction."
    for how in (
        "each clip beside the mean of its condition",
        "of a comparison, the difference of two scores beside the win share",
    )
)
_FILE: Final = "metrics_against_people.csv"
_MOST_NAMED: Final = 5
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
        return Section(anchor="against-people", heading=heading, paragraphs=(_nothing(asked),))
    return Section(
        anchor="against-people",
        heading=heading,
        paragraphs=(
            *_how_little(measured),
            _decided(measured),
            _READING[report.protocol == "pairwise"],
        ),
        pictures=(*_forests(measured, subject), *_scatters(measured, report, subject)),
        tables=(_table(measured, report.protocol),),
    )


def _nothing(asked: Sequence[_Question]) -> str:
    reasons = dict.fromkeys(one.found.reason for one in asked if one.found.reason)
    if reasons:
        return _sentence("; ".join(reasons))
    return "No metric has a score of the conditions that were judged: there is nothing to compare."


def how_little(found: SamplingRange) -> str:
    """Return in a sentence how little so many conditions can say."""
    inside = (
        "; a metric that has nothing to do with preference could look the same"
        if found.low <= 0
        else ""
    )
    return (
        f"With {found.conditions} conditions, a true Kendall's τ of {wording.share(found.tau)} "
        f"would show as anything from {_correlation(found.low)} to {_correlation(found.high)} in "
        f"95 of 100 studies, even if preferences and scores were known without error{inside}."
    )


def _how_little(asked: Sequence[_Question]) -> Iterator[str]:
    ranges = {
        one.found.conditions: one.found.sampling_range for one in asked if one.found.sampling_range
    }
    for found in ranges.values():
        yield how_little(found)
    if not ranges:
        yield (
            "Two conditions always agree with a metric entirely or not at all, so there is no "
            "correlation over conditions."
        )


def _decided(asked: Sequence[_Question]) -> str:
    """Return which intervals leave out zero."""
    over = [(one, metric, metric.kendall) for one in asked for metric in one.metrics]
    within = [(one, metric, metric.within) for one in asked for metric in one.metrics]
    sentences = [
        _leaving_out_zero("over conditions", over),
        _leaving_out_zero("within conditions", within),
    ]
    return (
        f"{' '.join(sentences)} No correction for their number is made: about one in twenty would "
        "leave out zero by chance."
    )


def _leaving_out_zero(
    where: str,
    found: Sequence[tuple[_Question, MetricAgainstPeople, RankCorrelation | WithinCorrelation]],
) -> str:
    known = [one for one in found if not math.isnan(one[2].low)]
    if not known:
        return f"There is no interval {where}."
    clear = [
        f"{metric.metric} on {one.name} ({_correlation_words(number)})"
        for one, metric, number in known
        if number.low > 0 or number.high < 0
    ]
    named = clear[:_MOST_NAMED]
    if len(clear) > _MOST_NAMED:
        named.append(f"{len(clear) - _MOST_NAMED} more")
    verb = f"{len(clear)} leave out zero: {listed(named)}" if clear else "none leaves out zero"
    if len(clear) == 1:
        verb = f"that of {clear[0]} leaves out zero"
    return f"Of {wording.count(len(known), 'interval')} {where}, {verb}."


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
        left = f" The first {MOST} of {len(drawn)} metrics." if len(drawn) > MOST else ""
        yield from agreement_pictures(
            drawn[:MOST],
            list(dict.fromkeys([*order, *names])),
            _UPRIGHT[report.protocol],
            About(
                name=f"metrics-against-people-{number}",
                title=f"Metrics against preference: {one.name}",
                caption=f"{wording.heading(one.name)}: each metric against people's preference "
                f"({one.found.preference}; lines: 95% of resamples of {subject.people} and "
                "segments). Axes run towards what the metric calls better, so where both agree "
                f"marks rise.{left}",
                data=_FILE,
                mark=subject.mark,
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
            about = About(
                name="metric-correlations"
                + (f"-{number}" if of else "")
                + (f"-{sheet + 1}" if sheets > 1 else ""),
                title=f"Correlations of metrics with preference{where}",
                caption=f"Agreement of each metric with people{where}, with 95% intervals: over "
                "conditions, and over clips within conditions. Hollow marks have no interval; the "
                "notes under the table say why.",
                data=_FILE,
                mark=subject.mark,
            )
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
                about,
                series=[wording.heading(question) for question in questions],
            )


def _dot(found: RankCorrelation | WithinCorrelation | None) -> Dot:
    if found is None or math.isnan(found.estimate):
        return Dot(hint="–")
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        hint=_correlation_words(found),
        descriptive=math.isnan(found.low),
    )


def _correlation_words(found: RankCorrelation | WithinCorrelation) -> str:
    """Return a correlation with its interval where it has one, '.52 [.11, .79]'."""
    inside = "" if math.isnan(found.low) else f" {_interval_words(found)}"
    return f"{_correlation(found.estimate)}{inside}"


def _interval_words(found: RankCorrelation | WithinCorrelation) -> str:
    return between(_correlation(found.low), _correlation(found.high))


def _correlation(value: float) -> str:
    """Return a correlation as a share, '1' and '−1' without decimals."""
    if not math.isnan(value) and abs(value) > 0.995:
        return "1" if value > 0 else "−1"
    return wording.share(value)


def _table(asked: Sequence[_Question], protocol: str) -> Table:
    reasons: dict[str, int] = {}
    correlations = {"Kendall's τ-b": "kendall", "Spearman's ρ": "spearman", "r": "within"}
    table = table_of(
        [(one, metric) for one in asked for metric in one.metrics],
        ("question", lambda row: row[0].name),
        ("metric", lambda row: f"{row[1].metric} {ARROWS[row[1].better]}".rstrip()),
        ("conditions", lambda row: count_cell(row[1].conditions)),
        *(
            column
            for heading, which in correlations.items()
            for column in (
                (heading, partial(_estimate, which)),
                ("95% interval", partial(_interval, which, reasons)),
            )
        ),
        (
            "pairs of clips" if protocol == "pairwise" else "clips",
            lambda row: count_cell(row[1].within.cells),
        ),
        caption="Correlation of automatic metrics with people's preference, signed by the metric's "
        "own direction.",
        groups=(("", 3), ("over conditions", 4), ("within conditions", 3)),
        name="metrics-against-people",
        data=_FILE,
    )
    # The reasons were numbered while the rows were written.
    numbered = (f"({number}) {_sentence(reason)}" for reason, number in reasons.items())
    return replace(table, notes=(*numbered, *_left_out(asked), *_resampling(asked)))


def _estimate(which: str, row: tuple[_Question, MetricAgainstPeople]) -> Cell:
    estimate = getattr(row[1], which).estimate
    if math.isnan(estimate):
        return Cell(text="–")
    return Cell(text=_correlation(estimate), value=estimate)


def _interval(
    which: str, reasons: dict[str, int], row: tuple[_Question, MetricAgainstPeople]
) -> Cell:
    found: RankCorrelation | WithinCorrelation = getattr(row[1], which)
    number = reasons.setdefault(found.reason, len(reasons) + 1) if found.reason else None
    if not math.isnan(found.estimate) and not math.isnan(found.low):
        return Cell(text=_interval_words(found))
    return Cell(text=f"–{wording.NO_BREAK}" + ("" if number is None else f"({number})"))


def _left_out(asked: Sequence[_Question]) -> Iterator[str]:
    """Yield which conditions are not correlated, and why, each reason once."""
    about: dict[tuple[str, str], list[str]] = {}
    for one in asked:
        for metric in one.metrics:
            for reason in dict.fromkeys(metric.left_out.values()):
                names = [name for name, why in metric.left_out.items() if why == reason]
                words = listed([wording.condition(name) for name in names])
                metrics = about.setdefault((words, reason), [])
                if metric.metric not in metrics:
                    metrics.append(metric.metric)
    for (words, reason), metrics in about.items():
        yield f"Left out of {listed(metrics)}: {words} ({reason.rstrip('.')})."


def _resampling(asked: Sequence[_Question]) -> Iterator[str]:
    one = asked[0].found
    most = max(metric.kendall.degenerate for own in asked for metric in own.metrics)
    yield (
        f"People's side: {one.preference}. {one.method}; {one.resamples:,} resamples, of which at "
        f"most {most:,} had no correlation and are left out. Scores of whole conditions, such as "
        "Fréchet distances, are not resampled."
    )
    yield (
        "Within conditions: Pearson's r of what is left when the mean of each condition (of each "
        "pair of conditions) is taken off, weighted by answers; the interval leaves out one "
        "segment after the other (jackknife on Fisher's scale, t)."
    )


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
