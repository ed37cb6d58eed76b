"""The section that sets automatic metrics against what people preferred."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from analysis.against_people.result import (
    AgainstPeople,
    MetricAgainstPeople,
    RankCorrelation,
    SamplingRange,
    WithinCorrelation,
)
from analysis.report import wording
from analysis.report.agreement_figure import MOST, agreement_figure
from analysis.report.by_question import each_question, question_name
from analysis.report.content import Cell, Picture, Section, Table
from analysis.report.headline.dot_figure import Dot, dot_pictures
from analysis.report.headline.panels import RowName, Scale
from analysis.report.metric_ranking import ARROWS
from analysis.report.subject import Subject
from analysis.results.report import TableReport
from motion.listing import listed

Found = tuple[str, AgainstPeople]
"""A question, with its set where there are any, and what was found."""

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
_TAU: Final = "over conditions (τ-b)"
_WITHIN: Final = "within conditions (r)"


def against_people_section(report: TableReport, subject: Subject) -> Section | None:
    """Return how metrics and preferences agree; None where nothing was measured or answered."""
    found: list[Found] = [
        (question_name(of, question), one)
        for of, question, one in each_question(report.metrics_against_people, report.sets)
    ]
    if not found:
        return None
    heading = "Do the metrics agree with people?"
    measured = [(question, one) for question, one in found if one.metrics]
    if not measured:
        return Section(
            anchor="against-people",
            heading=heading,
            paragraphs=tuple(dict.fromkeys(f"{_sentence(one.reason)}" for _, one in found)),
        )
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


def how_little(found: SamplingRange) -> str:
    """Return in a sentence how little so many conditions can say."""
    inside = (
        "; a metric that has nothing to do with preference could look the same"
        if found.low <= 0
        else ""
    )
    return (
        f"With {found.conditions} conditions, a true Kendall's τ of {wording.share(found.tau)} "
        f"would show as anything from {wording.share(found.low)} to {_one(found.high)} in 95 of "
        f"100 studies, even if preferences and scores were known without error{inside}."
    )


def _how_little(found: Sequence[Found]) -> Iterator[str]:
    ranges = {
        one.sampling_range.conditions: one.sampling_range for _, one in found if one.sampling_range
    }
    for one in ranges.values():
        yield how_little(one)
    if not ranges:
        yield (
            "Two conditions always agree with a metric entirely or not at all, so there is no "
            "correlation over conditions."
        )


def _decided(found: Sequence[Found]) -> str:
    """Return which intervals leave out zero."""
    over = [
        f"{metric.metric} on {question} ({_estimate(metric.kendall)})"
        for question, one in found
        for metric in one.metrics
        if _excludes_zero(metric.kendall)
    ]
    within = [
        f"{metric.metric} on {question} ({_estimate(metric.within)})"
        for question, one in found
        for metric in one.metrics
        if _excludes_zero(metric.within)
    ]
    tried = sum(len(one.metrics) for _, one in found)
    return (
        f"Of {wording.count(tried, 'interval')} over conditions, "
        f"{f'those of {listed(over)} leave out zero' if over else 'none leaves out zero'}; within "
        f"conditions, {f'those of {listed(within)} do' if within else 'none does'}. No correction "
        "for their number is made: about one in twenty would by chance."
    )


def _excludes_zero(found: RankCorrelation | WithinCorrelation) -> bool:
    return found.low > 0 or found.high < 0


def _scatters(found: Sequence[Found], report: TableReport, subject: Subject) -> Iterator[Picture]:
    for number, (question, one) in enumerate(found, start=1):
        drawn = [m for m in one.metrics if any(not math.isnan(p.preference) for p in m.places)]
        if not drawn or one.conditions < 3:
            continue
        names = [place.condition for metric in drawn for place in metric.places]
        order = [name for name in subject.conditions if name in names]
        left = f" The first {MOST} of {len(drawn)} metrics." if len(drawn) > MOST else ""
        yield agreement_figure(
            drawn[:MOST],
            list(dict.fromkeys([*order, *names])),
            preference=_UPRIGHT[report.protocol],
            name=f"metrics-against-people-{number}",
            title=f"Metrics against preference: {question}",
            caption=f"{wording.heading(question)}: each metric against people's preference "
            f"({one.preference}; lines: 95 % of resamples of {subject.people} and segments). Axes "
            f"run towards what the metric calls better, so where both agree marks rise.{left}",
            data="metrics-against-people.csv",
            mark=subject.mark,
        )


def _forests(found: Sequence[Found], subject: Subject) -> tuple[Picture, ...]:
    names = list(dict.fromkeys(metric.metric for _, one in found for metric in one.metrics))
    panels: dict[str, list[Dot]] = {}
    for question, one in found:
        by_name = {metric.metric: metric for metric in one.metrics}
        heading = wording.heading(question)
        panels[f"{heading}, {_TAU}"] = [_dot(by_name, name, "kendall") for name in names]
        panels[f"{heading}, {_WITHIN}"] = [_dot(by_name, name, "within") for name in names]
    if all(math.isnan(dot.estimate) for dots in panels.values() for dot in dots):
        return ()
    told = {
        title: f"{title}: "
        + ", ".join(f"{name} {dot.words}" for name, dot in zip(names, dots, strict=True))
        + "."
        for title, dots in panels.items()
    }
    return dot_pictures(
        panels,
        [RowName(name=name) for name in names],
        Scale(
            limits=(-1.05, 1.05),
            ticks={-1: "−1", -0.5: "−.5", 0: "0", 0.5: ".5", 1: "1"},
            ends=("disagrees", "agrees"),
            line=0.0,
        ),
        name="metric-correlations",
        title="Correlations of metrics with preference",
        told=told,
        caption="Agreement of each metric with people, with 95 % intervals: over conditions, and "
        "over clips within conditions.",
        data="metrics-against-people.csv",
        mark=subject.mark,
    )


def _dot(metrics: Mapping[str, MetricAgainstPeople], name: str, which: str) -> Dot:
    metric = metrics.get(name)
    if metric is None:
        return Dot(estimate=math.nan, words="–")
    found = metric.kendall if which == "kendall" else metric.within
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        words=_one(found.estimate),
        below=_between(found),
        hint=f"{name}: {_estimate(found)}",
        descriptive=math.isnan(found.low),
    )


def _table(found: Sequence[Found], protocol: str) -> Table:
    reasons: dict[str, int] = {}
    rows = []
    for question, one in found:
        for metric in one.metrics:
            arrow = ARROWS[metric.better]
            rows.append(
                (
                    Cell(text=question),
                    Cell(text=f"{metric.metric}{f' {arrow}' if arrow else ''}"),
                    Cell(text=str(metric.conditions), value=metric.conditions),
                    *_cells(metric.kendall, reasons),
                    *_cells(metric.spearman, reasons),
                    *_cells(metric.within, reasons),
                    Cell(text=str(metric.within.cells), value=metric.within.cells),
                )
            )
    return Table(
        caption="Correlation of automatic metrics with people's preference, signed by the metric's "
        "own direction.",
        groups=(("", 3), ("over conditions", 4), ("within conditions", 3)),
        header=(
            *("question", "metric", "conditions"),
            *("Kendall's τ-b", "95 % interval", "Spearman's ρ", "95 % interval"),
            *("r", "95 % interval", "pairs of clips" if protocol == "pairwise" else "clips"),
        ),
        rows=tuple(rows),
        text_columns=2,
        notes=(
            *(f"({number}) {_sentence(reason)}" for reason, number in reasons.items()),
            *_left_out(found),
            *_resampling(found),
        ),
        name="metrics-against-people",
    )


def _cells(
    found: RankCorrelation | WithinCorrelation, reasons: dict[str, int]
) -> tuple[Cell, Cell]:
    note = ""
    if found.reason:
        note = f"({reasons.setdefault(found.reason, len(reasons) + 1)})"
    if math.isnan(found.estimate):
        return Cell(text="–"), Cell(text=f"–{wording.NO_BREAK}{note}")
    estimate = Cell(text=_one(found.estimate), value=found.estimate)
    if math.isnan(found.low):
        return estimate, Cell(text=f"–{wording.NO_BREAK}{note}")
    return estimate, Cell(text=_between(found))


def _left_out(found: Sequence[Found]) -> Iterator[str]:
    """Yield which conditions are not correlated, and why, each reason once."""
    about: dict[tuple[str, str], list[str]] = {}
    for _, one in found:
        for metric in one.metrics:
            for condition, reason in metric.left_out.items():
                metrics = about.setdefault((condition, reason), [])
                if metric.metric not in metrics:
                    metrics.append(metric.metric)
    for (condition, reason), metrics in about.items():
        yield f"{wording.name(condition)} is left out of {listed(metrics)}: {reason.rstrip('.')}."


def _resampling(found: Sequence[Found]) -> Iterator[str]:
    one = found[0][1]
    most = max((metric.kendall.degenerate for _, own in found for metric in own.metrics), default=0)
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


def _estimate(found: RankCorrelation | WithinCorrelation) -> str:
    inside = _between(found)
    return f"{_one(found.estimate)}{f' {inside}' if inside else ''}"


def _between(found: RankCorrelation | WithinCorrelation) -> str:
    if math.isnan(found.low):
        return ""
    return f"[{_one(found.low)},{wording.NO_BREAK}{_one(found.high)}]"


def _one(value: float) -> str:
    """Return a correlation as a share, '1' and '−1' without decimals."""
    if not math.isnan(value) and abs(value) > 0.995:
        return "1" if value > 0 else "−1"
    return wording.share(value)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
