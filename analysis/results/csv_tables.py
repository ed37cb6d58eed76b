"""The results as flat tables for programs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from analysis.results.plain import plain
from analysis.results.report import TableReport

_LISTS = ("rules", "comparisons", "conditions", "contrasts", "equivalence")
_BY_QUESTION = (
    "side_bias",
    "agreement",
    "test_retest",
    "bradley_terry",
    "clmm",
    "plackett_luce",
    "kendall_w",
    "friedman",
)


def csv_tables(report: TableReport) -> dict[str, pd.DataFrame]:
    """Return tables by file name: one row an entry, nested names joined by '_'."""
    results: Any = plain(report.keys())
    excluded = [{"participant": who, "reason": why} for who, why in results["exclusions"].items()]
    rows = {"exclusions": excluded} | {name: results[name] for name in _LISTS if name in results}
    for name in _BY_QUESTION:
        if name in results:
            rows[name] = _rows(results[name], with_sets=bool(report.sets))
    return {
        f"{name}.csv": pd.json_normalize(found, sep="_") for name, found in rows.items() if found
    }


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


def _rows(found: Mapping[str, Any], *, with_sets: bool) -> list[dict[str, Any]]:
    if not with_sets:
        return [{"question": question, **one} for question, one in found.items()]
    return [
        {"set": name, "question": question, **one}
        for name, questions in found.items()
        for question, one in questions.items()
    ]
