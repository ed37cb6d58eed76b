"""The results as flat tables for programs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import pandas as pd

from analysis.results.plain import plain
from analysis.results.report import TableReport

_PER_REPORT: Final = ("rules", "flow", "sensitivity")
"""Lists that every report has, beside what its protocol gives."""


def csv_tables(report: TableReport) -> dict[str, pd.DataFrame]:
    """Return tables by file name: one row an entry, nested names joined by '_'."""
    results: Any = plain(report.keys())
    rules = [rule.rule for rule in report.rules]
    excluded = [{"participant": who, "reason": why} for who, why in results["exclusions"].items()]
    rows = {"exclusions": excluded}
    for name in (*_PER_REPORT, *vars(report.results)):
        if not isinstance(results[name], str):
            rows[name] = _rows(results[name], with_sets=bool(report.sets))
    beside = _rows(results["metrics_against_people"], with_sets=bool(report.sets))
    rows["metrics_against_people"] = [row for one in beside for row in _metrics(one)]
    rows["heterogeneity"] = [row for one in rows["heterogeneity"] for row in _levels(one)]
    for flow in rows["flow"]:
        counts = zip(rules, flow.pop("removed"), strict=True)
        flow |= {f"removed_{place}_{rule}": n for place, (rule, n) in enumerate(counts, start=1)}
    return {
        f"{name}.csv": pd.json_normalize([_flat(one) for one in found], sep="_")
        for name, found in rows.items()
        if found
    }


def _rows(found: Any, *, with_sets: bool) -> list[dict[str, Any]]:
    """Return a list of results, or results by question, as rows."""
    if isinstance(found, list):
        return [dict(one) for one in found]
    if not with_sets:
        return [row for question, one in found.items() for row in _of(one, question=question)]
    return [
        row
        for name, questions in found.items()
        for question, one in questions.items()
        for row in _of(one, set=name, question=question)
    ]


def _of(found: Any, **place: str) -> list[dict[str, Any]]:
    """Return the rows of one question: one, or one for each entry of a list."""
    if isinstance(found, list):
        return [place | dict(one) for one in found]
    return [place | dict(found)]


def _levels(entry: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return a row for each level of an effect that was taken apart, its test in all of them."""
    shared = {name: value for name, value in entry.items() if name != "levels"}
    return [shared | {"level": level["level"]} | level for level in entry["levels"]]


def _metrics(entry: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return a row for each metric that was set beside the answers to a question."""
    place = {name: entry[name] for name in ("set", "question") if name in entry}
    nested = ("left_out", "places")
    return [
        place | {key: value for key, value in metric.items() if key not in nested}
        for metric in entry["metrics"]
    ]


def _flat(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Write lists of numbers or words into one cell, and leave lists of results out."""
    found: dict[str, Any] = {}
    for name, value in entry.items():
        if isinstance(value, Mapping):
            found[name] = _flat(value)
        elif not isinstance(value, list):
            found[name] = value
        elif not any(isinstance(one, Mapping) for one in value):
            found[name] = "; ".join(map(str, value))
    return found
