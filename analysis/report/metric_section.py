"""The section that sets automatic metrics beside the answers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from analysis.metrics.conditions import ConditionScore
from analysis.report import wording
from analysis.report.answer import figure_order, people
from analysis.report.content import Cell, Section, Table, cells
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs
from motion.listing import listed

_IN_FULL = ("beat alignment (", "beat alignment by chance")
"""Metrics that only the CSV shows: they mean nothing without their difference."""


def metrics_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return automatic metrics per condition, below what was answered about it."""
    answered = inputs.origin != "none"
    heading = "Automatic metrics beside the answers" if answered else "Automatic metrics"
    scores = findings.metrics.conditions
    if not scores:
        return Section(
            anchor="metrics",
            heading=heading,
            paragraphs=("The study has no motion files, so there is nothing to measure.",),
        )
    present = {score.condition for score in scores}
    conditions = [c for c in (*inputs.conditions, inputs.catch_condition) if c in present]
    conditions += sorted(present - set(conditions))
    names = [
        name
        for name in dict.fromkeys(score.name for score in scores)
        if not name.startswith(_IN_FULL)
    ]
    by_place = {(score.condition, score.name): score for score in scores}
    rows = []
    if answered:
        rows = [_human_row(q, conditions, inputs, findings) for q in figure_order(inputs)]
    rows += [_metric_row(name, conditions, by_place) for name in names]
    table = Table(
        caption=_metrics_caption(inputs, answered=answered),
        header=("measure", *(wording.name(c) for c in conditions)),
        rows=tuple(rows),
        notes=(*_settings(names, scores), *_missing(names, scores)),
        data="metrics.csv",
    )
    reading = (
        "Beat alignment is shown above its chance level, because dense beats score high against "
        "any speech. Deviation and distance reward noise as much as variety: read them beside "
        "jerk."
    )
    compared = wording.count(len(set(conditions) - {inputs.catch_condition}), "condition")
    caution = (
        f"With {compared}, a correlation between metrics and answers would be too uncertain to "
        "report; the numbers stand side by side for reading."
    )
    return Section(
        anchor="metrics",
        heading=heading,
        paragraphs=(f"{caution} {reading}" if answered else reading,),
        tables=(table,),
    )


def _metrics_caption(inputs: ReportInputs, *, answered: bool) -> str:
    metrics = "each metric per condition, as mean over clips ± standard deviation between clips"
    if not answered:
        return f"{metrics[0].upper()}{metrics[1:]}."
    return (
        f"What {people(inputs)} preferred and what the metrics say. First the share of answers "
        f"preferring the condition to {wording.name(inputs.reference)}, with its interval; then "
        f"{metrics}."
    )


def _human_row(
    question: str, conditions: Sequence[str], inputs: ReportInputs, findings: Findings
) -> tuple[Cell, ...]:
    shares = {p.other: p.win_share for p in findings.preferences if p.question == question}
    row = [Cell(text=f"preferred to {wording.name(inputs.reference)}: {wording.name(question)}")]
    for condition in conditions:
        mean = shares.get(condition)
        if condition == inputs.reference:
            text = "reference"
        elif mean is None:
            text = "catch trials only" if condition == inputs.catch_condition else "–"
        elif mean.reason:
            text = wording.share(1 - mean.estimate)
        else:
            text = (
                f"{wording.share(1 - mean.estimate)} "
                f"[{wording.share(1 - mean.high)}, {wording.share(1 - mean.low)}]"
            )
        row.append(Cell(text=text))
    return tuple(row)


def _metric_row(
    name: str, conditions: Sequence[str], by_place: Mapping[tuple[str, str], ConditionScore]
) -> tuple[Cell, ...]:
    found = [by_place.get((condition, name)) for condition in conditions]
    scores = [score for score in found if score is not None]
    spreads = [score.spread for score in scores if not math.isnan(score.spread)]
    places = (
        wording.decimals(spreads, digits=2)
        if any(spreads)
        else wording.decimals([score.value for score in scores], digits=3)
    )
    unit = f", {scores[0].unit}" if scores[0].unit else ""
    return cells(f"{name}{unit}", *(_score(score, places) for score in found))


def _score(score: ConditionScore | None, places: int) -> str:
    if score is None:
        return "–"
    value = wording.fixed(score.value, places)
    spread = wording.fixed(score.spread, places)
    return value if spread in {"–", "0"} else f"{value} ± {spread}"


def _settings(names: Sequence[str], scores: Sequence[ConditionScore]) -> list[str]:
    """Return one footnote per set of settings, naming all metrics that share it."""
    shared: dict[str, list[str]] = {}
    for name in names:
        settings = next(score.settings for score in scores if score.name == name)
        words = "; ".join(f"{key}: {value}" for key, value in settings.items())
        shared.setdefault(words.replace("_", " "), []).append(name)
    return [f"{listed(sharing)} – {words}." for words, sharing in shared.items()]


def _missing(names: Sequence[str], scores: Sequence[ConditionScore]) -> list[str]:
    return [
        f"{wording.name(score.condition)}, {score.name}: {score.reason}."
        for score in scores
        if score.reason and score.name in names
    ]
