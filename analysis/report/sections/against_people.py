"""Whether automatic metrics agree with people's preference."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from analysis.report import wording
from analysis.report.content import FigureText, Picture, Section, Subject, Table
from analysis.report.figures.estimates import Dot, dot_of, dot_pictures, series_legend
from analysis.report.figures.panels import Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import LINE, PAPER, Scale, fit_text, series_style
from analysis.report.sections.metric_table import ARROWS
from analysis.report.sections.metrics import PAPER_OF, PAPER_TABLES, is_detail
from analysis.report.texts import figure_text, paragraphs, sentence, table
from analysis.report.wording import between, question_name
from analysis.results.against_people import AgainstPeople, MetricAgainstPeople
from analysis.results.grouping import Row as QuestionRow
from analysis.results.rank_correlations import FEWEST_FOR_INTERVAL, SamplingRange
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import Interval
from motion.errors import listed

_Question = QuestionRow[AgainstPeople]
"""The agreement on one question, without metrics that have no score or are details."""

_PREFERENCE_AXIS: Final = {
    "pairwise": "strength (logits)",
    "rating": "mean rating",
    "ranking": "minus the mean rank",
    "mismatch": "win share of own speech",
}
_MOST_ROWS: Final = 24
"""Most metrics on one sheet of the forest plot."""

_PANELS: Final = {"Over conditions: Kendall's τ-b": "kendall", "Within conditions: r": "within"}
"""The correlations of the forest plot; one without any estimate is not drawn."""

_CORRELATION: Final = Scale(
    limits=(-1.05, 1.05),
    ticks={-1: "−1", -0.5: "−.5", 0: "0", 0.5: ".5", 1: "1"},
    label="← disagrees, agrees →",
    line=0.0,
)


def against_people_section(report: TableReport, subject: Subject) -> Section | None:
    """Return how metrics and preferences agree; None if nothing was measured or answered."""
    questions = [
        row._replace(result=_without_details(row.result, report.protocol))
        for row in report.metrics_against_people.rows()
    ]
    if not questions:
        return None
    heading = "Do the metrics agree with people?"
    measured = [question for question in questions if question.result.metrics]
    if not measured:
        reasons = dict.fromkeys(q.result.reason for q in questions if q.result.reason)
        nothing = paragraphs("against_people.nothing", reasons=[*reasons])
        return Section(anchor="against-people", heading=heading, paragraphs=nothing)
    ranges = {
        agreement.conditions: agreement.sampling_range
        for _, _, agreement in measured
        if agreement.sampling_range and any(m.conditions > 2 for m in agreement.metrics)
    }
    return Section(
        anchor="against-people",
        heading=heading,
        paragraphs=paragraphs(
            "against_people.section",
            ranges=[sampling_range_sentence(sample) for sample in ranges.values()],
            intervals=[
                ("over conditions", *_intervals(measured, "kendall")),
                ("within conditions", *_intervals(measured, "within")),
            ],
            protocol=report.protocol,
        ),
        pictures=(*_forests(measured), *_scatters(measured, report, subject)),
        tables=(_table(measured, report.protocol),),
    )


def _without_details(agreement: AgainstPeople, protocol: str) -> AgainstPeople:
    metrics = (m for m in agreement.metrics if m.conditions and not is_detail(m.metric, protocol))
    return replace(agreement, metrics=tuple(metrics))


def sampling_range_sentence(sample: SamplingRange) -> str:
    """Return a sentence on how little this number of conditions can show."""
    return sentence("against_people.sampling_range", sample=sample, correlation=_correlation)


def _intervals(questions: Sequence[_Question], correlation: str) -> tuple[int, list[str]]:
    """Return the number of intervals, and the correlations whose intervals exclude zero."""
    intervals = [
        (f"{metric.metric} on {_name(question)}", interval)
        for question in questions
        for metric in question.result.metrics
        if (interval := getattr(metric, correlation)).has_interval
    ]
    significant = [
        f"{name} ({_correlation(interval.estimate)} {_ends(interval)})"
        for name, interval in intervals
        if interval.low > 0 or interval.high < 0
    ]
    return len(intervals), significant


def _scatters(
    questions: Sequence[_Question], report: TableReport, subject: Subject
) -> Iterator[Picture]:
    in_paper = [column.metric for column in PAPER_TABLES[PAPER_OF[report.protocol]]]
    for number, question in enumerate(questions, start=1):
        metrics = [
            metric
            for metric in question.result.metrics
            if any(not math.isnan(place.preference) for place in metric.places)
        ]
        if not metrics or question.result.conditions < FEWEST_FOR_INTERVAL:
            continue
        metrics.sort(key=lambda metric: metric.metric not in in_paper)
        names = [place.condition for metric in metrics for place in metric.places]
        order = [name for name in subject.conditions if name in names]
        yield from agreement_pictures(
            metrics[:MOST_METRICS],
            list(dict.fromkeys([*order, *names])),
            _PREFERENCE_AXIS[report.protocol],
            figure_text(
                "metrics-against-people",
                suffix=f"-{number}",
                name=_name(question),
                preference=question.result.preference,
                people=subject.people,
                shown=MOST_METRICS,
                all=len(metrics),
            ),
        )


MOST_METRICS: Final = 6
"""Most metrics in one figure that stay readable on a page."""

_SCATTER_HEIGHT: Final = 1.25
_AXIS_LABELS: Final = {
    "higher": "score{unit}, more is better →",
    "lower": "score{unit}, less is better →",
    "near the reference": "distance from recorded{unit} →",
}


def agreement_pictures(
    metrics: Sequence[MetricAgainstPeople],
    conditions: Sequence[str],
    preference: str,
    text: FigureText,
) -> tuple[Picture, ...]:
    """Draw each metric against preference; marks rise to the right where both agree.

    Parameters
    ----------
    metrics : sequence of MetricAgainstPeople
        At most `MOST_METRICS`, each with at least one place.
    conditions : sequence of str
        All conditions; each has its own colour and marker.
    preference : str
        Label of the vertical axis.
    text : FigureText
        The text around the figure.
    """
    by_name = {metric.metric: metric for metric in metrics}
    places = [place for metric in metrics for place in metric.places]
    ends = [
        value for p in places for value in (p.preference, p.low, p.high) if not math.isnan(value)
    ]
    margin = 0.09 * (max(ends) - min(ends)) or 0.5

    def draw(panel: Panel, name: str) -> Iterator[str]:
        [axes], metric = panel.axes, by_name[name]
        for place in metric.places:
            colour, marker = series_style(conditions.index(place.condition))
            # If nearness counts, the distance from recorded motion is shown.
            is_near = metric.better == "near the reference"
            score = abs(place.score - metric.recorded) if is_near else place.score
            axes.plot([score] * 2, [place.low, place.high], color=colour, linewidth=1.1)
            axes.plot(
                [score],
                [place.preference],
                marker,
                markersize=5,
                color=colour,
                markeredgecolor=PAPER,
                markeredgewidth=0.5,
            )
            yield (
                f"{wording.condition(place.condition)} {wording.quantity(place.score)} "
                f"with preference {wording.number(place.preference)}"
            )
        axes.margins(x=0.09)
        if metric.better != "higher":
            axes.invert_xaxis()
        axes.set_ylim(min(ends) - margin, max(ends) + margin)
        axes.locator_params(nbins=4, steps=(1, 2, 5, 10))
        axes.tick_params(labelsize=6.5, pad=1.5, length=2)
        axes.grid(color=LINE, linewidth=0.4)
        axes.set_axisbelow(True)
        unit = f" ({metric.unit})" if metric.unit else ""
        label = _AXIS_LABELS[metric.better].format(unit=unit)
        axes.set_xlabel(fit_text(label, panel.inches - 0.4, size=7), fontsize=7, labelpad=2)
        if panel.is_first:
            axes.set_ylabel(fit_text(preference, _SCATTER_HEIGHT, size=7), fontsize=7, labelpad=2)

    legend = series_legend([wording.condition(name) for name in conditions])
    figure = PanelFigure(
        titles=[*by_name], draw=draw, height=_SCATTER_HEIGHT, columns=3, legend=legend
    )
    return panel_pictures(figure, text)


def _forests(questions: Sequence[_Question]) -> Iterator[Picture]:
    """Draw the correlations of each set in forest plots of at most `_MOST_ROWS` metrics."""
    for number, set_name in enumerate(dict.fromkeys(q.set for q in questions), start=1):
        metrics = {
            (question.question, metric.metric): metric
            for question in questions
            if question.set == set_name
            for metric in question.result.metrics
        }
        if not any(m.kendall.has_interval or m.within.has_interval for m in metrics.values()):
            continue
        panels = {
            title: correlation
            for title, correlation in _PANELS.items()
            if any(not math.isnan(getattr(m, correlation).estimate) for m in metrics.values())
        }
        series = list(dict.fromkeys(question for question, _ in metrics))
        names = list(dict.fromkeys(name for _, name in metrics))
        sheets = -(-len(names) // _MOST_ROWS)
        for sheet in range(sheets):
            start, end = (len(names) * (sheet + k) // sheets for k in (0, 1))
            rows = [[metrics.get((q, name)) for q in series] for name in names[start:end]]
            yield from dot_pictures(
                {
                    title: [[_dot(getattr(m, correlation, None)) for m in row] for row in rows]
                    for title, correlation in panels.items()
                },
                [Row(name) for name in names[start:end]],
                _CORRELATION,
                figure_text(
                    "metric-correlations",
                    suffix=(f"-{number}" if set_name else "")
                    + (f"-{sheet + 1}" if sheets > 1 else ""),
                    of_set=f", set {wording.name(set_name)}" if set_name else "",
                ),
                series=[wording.heading(question) for question in series],
            )


def _name(question: _Question) -> str:
    return question_name(question.set, question.question)


def _dot(interval: Interval | None) -> Dot:
    dot = dot_of(interval, _correlation, missing="–")
    return replace(dot, words="", is_descriptive=math.isnan(dot.low))


def _ends(interval: Interval) -> str:
    return between(_correlation(interval.low), _correlation(interval.high))


def _correlation(value: float) -> str:
    """Return a correlation as a share, '1' and '−1' without decimals."""
    if not math.isnan(value) and abs(value) > 0.995:
        return "1" if value > 0 else "−1"
    return wording.share(value)


def _table(questions: Sequence[_Question], protocol: str) -> Table:
    rows = [(_name(question), m) for question in questions for m in question.result.metrics]
    intervals = [i for _, metric in rows for i in (metric.kendall, metric.spearman, metric.within)]
    unique = dict.fromkeys(interval.reason for interval in intervals if interval.reason)
    reasons = {reason: number for number, reason in enumerate(unique, start=1)}

    def ends(interval: Interval) -> str:
        if not math.isnan(interval.estimate) and interval.has_interval:
            return _ends(interval)
        mark = f"({reasons[interval.reason]})" if interval.reason else ""
        return f"–{wording.NO_BREAK}{mark}"

    without_notes = table(
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
        left_out=_left_out(questions),
        agreement=questions[0].result,
        most=max(metric.kendall.degenerate for _, metric in rows),
    )
    return replace(without_notes, notes=notes)


def _left_out(questions: Sequence[_Question]) -> dict[tuple[str, str], list[str]]:
    """Return metrics by the conditions that are left out of their correlations, and why."""
    metrics: dict[tuple[str, str], list[str]] = {}
    for metric in (metric for question in questions for metric in question.result.metrics):
        for reason in dict.fromkeys(metric.left_out.values()):
            names = [name for name, why in metric.left_out.items() if why == reason]
            key = listed([wording.condition(name) for name in names]), reason
            if metric.metric not in metrics.setdefault(key, []):
                metrics[key].append(metric.metric)
    return metrics
