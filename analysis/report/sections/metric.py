"""The section with the automatic metrics: the protocol's paper first, then all others.

A direction is the paper's own: AMUSE calls the diversity near that of recorded motion best,
DiffSHEG the greatest.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from analysis.measurement.scores import ConditionScore, StudyMetrics
from analysis.report.content import Section, Table
from analysis.report.sections.metric_table import Systems, TableColumn, metric_table
from analysis.report.subject import Subject
from analysis.report.texts import table, template
from analysis.results.report import TableReport

_PAPERS: Final = tomllib.loads(template("papers.toml"))

PAPER_TABLES: Final[Mapping[str, tuple[TableColumn, ...]]] = {
    paper: tuple(TableColumn(*column) for column in found["columns"])
    for paper, found in _PAPERS.items()
}
"""By preset."""

TITLES: Final = {paper: str(found["title"]) for paper, found in _PAPERS.items()}
"""What the papers are called, by preset."""


PAPER_OF: Final = {
    "pairwise": "amuse",
    "rating": "s2ue",
    "ranking": "diffsheg",
    "mismatch": "genea",
}
"""Whose table is shown first, by protocol: that of the paper which the protocol is taken from."""

_ENOUGH: Final = 0.5
"""Share of a paper's metrics that must be there for a table in its shape."""

_MOST_COLUMNS: Final = 6

_IN_FULL: Final = ("beat alignment (", "beat alignment by chance")
"""Metrics that mean nothing without their difference, which is shown in their place."""


def metric_section(report: TableReport, subject: Subject) -> Section:
    """Return the metrics of every condition, best and second best marked."""
    metrics = subject.metrics
    if metrics is None or not metrics.conditions:
        return Section(
            anchor="metrics",
            heading="Automatic metrics",
            paragraphs=(
                "There are no motion files, so there is nothing to measure.",
                *metrics_not_tabled(metrics),
            ),
        )
    return Section(
        anchor="metrics",
        heading="Automatic metrics",
        paragraphs=(
            "Metrics describe motion; they do not tell what people prefer. Beat alignment is best "
            "read above its chance level, because dense beats score high against any speech. "
            "Diversity rewards noise as much as variety: read it beside jerk and against recorded "
            "motion.",
        ),
        bullets=metrics_not_tabled(metrics),
        tables=(*metric_tables(metrics, report.protocol, subject), *confusion_tables(metrics)),
    )


def metric_tables(metrics: StudyMetrics, protocol: str, subject: Subject) -> tuple[Table, ...]:
    """Return a table in the shape of each paper whose metrics are there, and one of all others."""
    scores = {(score.condition, score.name): score for score in metrics.conditions}
    systems = systems_of(metrics, subject)
    found, shown = [], set()
    for paper in _papers(metrics.conditions, PAPER_OF.get(protocol, "")):
        columns = PAPER_TABLES[paper]
        shown |= {column.metric for column in columns}
        found.append(
            metric_table(
                columns,
                scores,
                systems,
                caption=f"Automatic metrics in the shape of the table of {TITLES[paper]}, computed "
                "as there.",
                name=f"metrics-{paper}",
                marks_generative=paper == "diffsheg",
            )
        )
    others, never = _others(metrics.conditions, shown)
    parts = -(-len(others) // _MOST_COLUMNS)
    for part in range(parts):
        # Shared out evenly, so that no table has a single column left over.
        start, end = (len(others) * (part + k) // parts for k in (0, 1))
        found.append(
            metric_table(
                others[start:end],
                scores,
                systems,
                caption="Further automatic metrics."
                if found and not part
                else "Automatic metrics."
                if not part
                else "Further automatic metrics, continued.",
                name=f"metrics-{part + 1}" if parts > 1 else "metrics-all",
            )
        )
    return (*found, *_never_measured(never))


def is_detail(metric: str, protocol: str) -> bool:
    """Tell whether a metric only helps to read another one, and is no column of the paper's."""
    own = PAPER_TABLES[PAPER_OF[protocol]] if protocol in PAPER_OF else ()
    return metric.startswith(_IN_FULL) and metric not in {column.metric for column in own}


def systems_of(metrics: StudyMetrics, subject: Subject) -> Systems:
    """Return the measured conditions: recorded motion first, that of catch trials last."""
    measured = dict.fromkeys(score.condition for score in metrics.conditions)
    order = [*subject.conditions, *measured]
    if subject.recorded is not None:
        order.insert(0, subject.recorded)
    names = [name for name in dict.fromkeys(order) if name in measured]
    if subject.broken in names:
        names.remove(subject.broken)
        names.append(subject.broken)
    return Systems(
        names=tuple(names),
        recorded=subject.recorded,
        broken=subject.broken if subject.broken not in subject.conditions else None,
        generative=subject.generative,
    )


def _papers(scores: Sequence[ConditionScore], own: str) -> Iterator[str]:
    """Yield the papers whose tables can be shown, the protocol's own first."""
    there = {score.name for score in scores if not math.isnan(score.value)}
    for paper in sorted(PAPER_TABLES, key=lambda name: name != own):
        count = sum(column.metric in there for column in PAPER_TABLES[paper])
        if count >= (1 if paper == own else _ENOUGH * len(PAPER_TABLES[paper])):
            yield paper


def _others(
    scores: Sequence[ConditionScore], shown: set[str]
) -> tuple[list[TableColumn], list[ConditionScore]]:
    """Return what no paper's table shows, and of which metrics there is no score at all."""
    there = {score.name for score in scores if not math.isnan(score.value)}
    first: dict[str, ConditionScore] = {}
    for score in scores:
        if score.name not in shown and not score.name.startswith(_IN_FULL):
            first.setdefault(score.name, score)
    columns = [
        TableColumn(metric=name, label=name, better=score.better)
        for name, score in first.items()
        if name in there
    ]
    return columns, [score for name, score in first.items() if name not in there]


def _never_measured(missing: Sequence[ConditionScore]) -> tuple[Table, ...]:
    """Return a table of the metrics that have no score, with the reasons."""
    if not missing:
        return ()
    return (table("metrics-missing", missing),)


def confusion_tables(metrics: StudyMetrics) -> Iterator[Table]:
    """Yield which emotions each condition's gestures were taken for."""
    for number, found in enumerate(metrics.confusions, start=1):
        rows = zip(found.spoken, found.counts, strict=True)
        yield table("emotion-confusion", rows, found=found, number=number)


def metrics_not_tabled(metrics: StudyMetrics | None) -> tuple[str, ...]:
    """Return what could not be measured, and which files could not be used."""
    if metrics is None:
        return ()
    return (
        *(f"{remark[:1].upper()}{remark[1:]}." for remark in metrics.remarks),
        *(f"Not used: {Path(file.where).name}: {file.what}." for file in metrics.skipped),
    )
