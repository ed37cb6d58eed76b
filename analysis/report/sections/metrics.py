"""Automatic metrics, the protocol's paper first, and playable pairs with their metrics.

A direction is the paper's own: AMUSE calls the diversity nearest to recorded motion best, DiffSHEG
the greatest.
"""

import math
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from analysis.metrics.scores import ConditionScore, MetricResult, StudyMetrics
from analysis.report import wording
from analysis.report.content import Section, Subject, Table
from analysis.report.sections.metric_table import ARROWS, Systems, TableColumn, metric_table
from analysis.report.texts import paragraphs, table, template_file
from analysis.results.heterogeneity import PreferredPair
from analysis.results.report import TableReport

_PAPERS: Final = tomllib.loads(template_file("papers.toml"))

PAPER_TABLES: Final[Mapping[str, tuple[TableColumn, ...]]] = {
    paper: tuple(TableColumn(*column) for column in keys["columns"])
    for paper, keys in _PAPERS.items()
}
"""The columns of each paper's table, by preset."""

TITLES: Final = {paper: str(keys["title"]) for paper, keys in _PAPERS.items()}
"""The names of the papers, by preset."""

PAPER_OF: Final = {
    "pairwise": "amuse",
    "rating": "s2ue",
    "ranking": "diffsheg",
    "mismatch": "genea",
}
"""The paper that a protocol is taken from, whose table is shown first."""

_ENOUGH: Final = 0.5
"""Share of a paper's metrics that a table in its layout needs."""

_MOST_COLUMNS: Final = 6

_DETAILS: Final = ("beat alignment (", "beat alignment by chance")
"""Metrics that mean nothing without their difference, which is shown in their place."""


def metric_section(report: TableReport, subject: Subject) -> Section:
    """Return the metrics of every condition, best and second best marked."""
    metrics = subject.metrics
    if metrics is None or not metrics.conditions:
        remarks = () if metrics is None else metrics_not_tabled(metrics)
        return Section(
            anchor="metrics",
            heading="Automatic metrics",
            paragraphs=(*paragraphs("metrics.nothing"), *remarks),
        )
    return Section(
        anchor="metrics",
        heading="Automatic metrics",
        paragraphs=paragraphs("metrics.reading"),
        bullets=metrics_not_tabled(metrics),
        tables=(*metric_tables(metrics, report.protocol, subject), *confusion_tables(metrics)),
    )


def metric_tables(metrics: StudyMetrics, protocol: str, subject: Subject) -> tuple[Table, ...]:
    """Return a table in the layout of each paper whose metrics were measured, and further ones."""
    systems = systems_of(metrics, subject)
    measured = {score.name for score in metrics.conditions if not math.isnan(score.value)}
    papers = _papers(measured, PAPER_OF.get(protocol, ""))
    tables = [
        metric_table(
            PAPER_TABLES[paper],
            systems,
            caption=f"Automatic metrics in the layout of the table of {TITLES[paper]}; the notes "
            "say how each is computed.",
            name=f"metrics-{paper}",
            marks_generative=paper == "diffsheg",
        )
        for paper in papers
    ]
    in_papers = {column.metric for paper in papers for column in PAPER_TABLES[paper]}
    others: dict[str, ConditionScore] = {}
    for score in metrics.conditions:
        if score.name not in in_papers and not score.name.startswith(_DETAILS):
            others.setdefault(score.name, score)
    columns = [
        TableColumn(metric=name, label=name, better=score.better)
        for name, score in others.items()
        if name in measured
    ]
    caption = "Further automatic metrics" if tables else "Automatic metrics"
    parts = -(-len(columns) // _MOST_COLUMNS)
    for part in range(parts):
        # Split evenly, so that no table has a single column left over.
        start, end = (len(columns) * (part + k) // parts for k in (0, 1))
        tables.append(
            metric_table(
                columns[start:end],
                systems,
                caption="Further automatic metrics, continued." if part else f"{caption}.",
                name=f"metrics-{part + 1}" if parts > 1 else "metrics-all",
            )
        )
    missing = [score for name, score in others.items() if name not in measured]
    return (*tables, *([table("metrics-missing", missing)] if missing else []))


def is_detail(metric: str, protocol: str) -> bool:
    """Return whether a metric only helps to read another, and is not in the paper's table."""
    in_paper = PAPER_TABLES[PAPER_OF[protocol]] if protocol in PAPER_OF else ()
    return metric.startswith(_DETAILS) and metric not in {column.metric for column in in_paper}


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
        scores={(score.condition, score.name): score for score in metrics.conditions},
        recorded=subject.recorded,
        broken=subject.broken if subject.broken not in subject.conditions else None,
        generative=subject.generative,
    )


def _papers(measured: set[str], first: str) -> list[str]:
    """Return the papers whose tables can be shown, the protocol's own first."""
    papers = []
    for paper in sorted(PAPER_TABLES, key=lambda name: name != first):
        count = sum(column.metric in measured for column in PAPER_TABLES[paper])
        if count >= (1 if paper == first else _ENOUGH * len(PAPER_TABLES[paper])):
            papers.append(paper)
    return papers


def confusion_tables(metrics: StudyMetrics) -> Iterator[Table]:
    """Yield the emotions that were named for the gestures of each condition."""
    for number, confusion in enumerate(metrics.confusions, start=1):
        rows = zip(confusion.spoken, confusion.counts, strict=True)
        yield table("emotion-confusion", rows, confusion=confusion, number=number)


def metrics_not_tabled(metrics: StudyMetrics) -> tuple[str, ...]:
    """Return sentences on what could not be measured, and on files that could not be used."""
    return (
        *(f"{remark[:1].upper()}{remark[1:]}." for remark in metrics.remarks),
        *(f"Not used: {Path(file.where).name}: {file.what}." for file in metrics.skipped),
    )


def played_pairs_section(subject: Subject) -> Section | None:
    """Return the pairs that play with their metrics; None if the page plays no motion."""
    motion = subject.motion
    if motion is None:
        return None
    return Section(
        anchor="motion",
        heading="The most and least preferred pairs",
        paragraphs=paragraphs("metrics.played_pairs") if motion.pairs else (),
        bullets=motion.left_out,
        playable=tuple(
            (
                element,
                _caption(pair, subject),
                _metrics_of_pair(pair, subject.metrics, subject.protocol),
            )
            for pair, element in motion.pairs
        ),
    )


def _caption(pair: PreferredPair, subject: Subject) -> str:
    shares = "; ".join(
        f"{wording.name(question)} {wording.share(share)} "
        f"({wording.count(pair.answers[question], 'answer')})"
        for question, share in pair.win_shares.items()
    )
    excerpt = subject.excerpts.get(pair.segment)
    speech = f" The speech: “{excerpt.transcript}”" if excerpt and excerpt.transcript else ""
    return (
        f"{wording.against(pair.first, pair.second)}, segment {wording.name(pair.segment)}. "
        f"Win share of {wording.condition(pair.first)}: {shares}.{speech}"
    )


def _metrics_of_pair(
    pair: PreferredPair, metrics: StudyMetrics | None, protocol: str
) -> Table | None:
    """Return the metrics that at least one of the two clips has."""
    results: dict[str, dict[str, MetricResult]] = {}
    for score in () if metrics is None else metrics.clips:
        name = score.result.name
        if score.segment == pair.segment and not is_detail(name, protocol):
            results.setdefault(name, {})[score.condition] = score.result
    rows = []
    for name, by_condition in results.items():
        values = {
            condition: by_condition[condition].value if condition in by_condition else math.nan
            for condition in (pair.first, pair.second)
        }
        if not all(map(math.isnan, values.values())):
            metric = next(iter(by_condition.values()))
            heading = f"{name} {ARROWS[metric.better]}".strip()
            rows.append({"heading": heading, "unit": metric.unit, "scores": values})
    return table("metrics-of-pair", rows, pair=pair) if rows else None
