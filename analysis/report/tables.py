"""A report's tables as files: CSV of all results, and any table for a paper, in LaTeX."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import Any, Final, cast

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.report.content import Cell, Table
from analysis.report.texts import template
from analysis.results.grouping import ByQuestion
from analysis.results.report import TableReport, plain
from motion.files import harmless_frame, replacing

LONGEST: Final = 40
"""Rows up to which a table floats; a longer one breaks over pages."""


def booktabs(table: Table, *, remark: str = "") -> str:
    """Return a table as a LaTeX file that compiles as it is, whatever its cells say.

    Parameters
    ----------
    table : Table
        Its caption and its notes go along; the best cells become bold, the second best underlined.
    remark : str, optional
        Put before the caption, such as that no person answered.
    """
    is_long = len(table.rows) > LONGEST
    ends = list(accumulate(span for _, span in table.groups))
    body = (
        _environment()
        .get_template("table.tex")
        .render(
            table=table,
            is_long=is_long,
            columns="l" * table.text_columns + "r" * (len(table.header) - table.text_columns),
            caption=f"{remark} {table.caption}".strip(),
            rules=[
                (end - span + 1, end)
                for (label, span), end in zip(table.groups, ends, strict=True)
                if label
            ],
        )
    )
    return "\n".join([*_needs(body, long=is_long), body])


@cache
def _environment() -> Environment:
    environment = Environment(  # noqa: S701 - what is written is LaTeX, escaped by its own filter
        loader=PackageLoader("analysis.report", "templates"),
        undefined=StrictUndefined,
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["latex"] = as_latex
    return environment


def as_latex(text: str) -> str:
    """Return text as LaTeX prints it, none of its signs taken for a command."""
    return text.translate(_latex_signs())


@cache
def _latex_signs() -> dict[int, str]:
    return str.maketrans(tomllib.loads(template("latex.toml")))


def _needs(body: str, *, long: bool) -> list[str]:
    packages = "booktabs,longtable" if long else "booktabs,graphicx"
    lines = [rf"% Needs \usepackage{{{packages}}} and \usepackage[T1]{{fontenc}}."]
    lines += (
        [r"% Needs \usepackage{textcomp} before LaTeX 2020."] if "textquotesingle" in body else []
    )
    if any(ord(sign) > 0x17F for sign in body):
        lines.append(
            "% Names hold letters that LuaLaTeX or XeLaTeX print with a font that has them."
        )
    return lines


def as_frame(table: Table) -> pd.DataFrame:
    """Return a table's numbers, and its words where there is no number behind them."""
    headings = _headings(table)
    return pd.DataFrame([[_value(cell) for cell in row] for row in table.rows], columns=headings)


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a table as CSV in one step, with nothing that a spreadsheet runs as a formula."""
    with replacing(path) as draft:
        harmless_frame(frame).to_csv(draft, index=False, lineterminator="\n")


def _headings(table: Table) -> list[str]:
    """Return the headings, those of groups before them."""
    groups = [label for label, span in table.groups for _ in range(span)] or [""] * len(
        table.header
    )
    return [f"{group} {name}".strip() for group, name in zip(groups, table.header, strict=True)]


def _value(cell: Cell) -> object:
    return cell.text if cell.value is None else float(f"{cell.value:.10g}")


_PER_REPORT: Final = ("rules", "flow", "sensitivity")
"""Lists that every report has, beside what its protocol gives."""


def csv_tables(report: TableReport) -> dict[str, pd.DataFrame]:
    """Return tables by file name: one row an entry, nested names joined by '_'."""
    keys, with_sets = report.keys(), bool(report.sets)
    rows: dict[str, list[dict[str, Any]]] = {
        "exclusions": [
            {"participant": who, "reason": why} for who, why in report.exclusions.items()
        ]
    }
    for name in (*_PER_REPORT, *vars(report.results)):
        if not isinstance(keys[name], str):
            rows[name] = _rows_of(keys[name], with_sets)
    beside = _rows_of(report.metrics_against_people, with_sets)
    rows["metrics_against_people"] = [row for one in beside for row in _metrics(one)]
    for name in {"heterogeneity", "bradley_terry", "plackett_luce"} & rows.keys():
        rows[name] = [row for one in rows[name] for row in _apart(one)]
    for flow in rows["flow"]:
        counts = zip((rule.rule for rule in report.rules), flow.pop("removed"), strict=True)
        flow |= {f"removed_{place}_{rule}": n for place, (rule, n) in enumerate(counts, start=1)}
    return {
        f"{name}.csv": pd.json_normalize([_flat(one) for one in found], sep="_")
        for name, found in rows.items()
        if found
    }


def _rows_of(found: Any, with_sets: bool) -> list[dict[str, Any]]:
    """Return a list of results, or results by question, as rows."""
    if not isinstance(found, ByQuestion):
        rows: Any = plain(found)
        return [*rows]
    return [
        ({"set": row.set} if with_sets else {})
        | {"question": row.question}
        | cast(Any, plain(row.found))
        for row in found.rows()
    ]


def _apart(entry: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return a row for each level of an effect, or each condition; what they share in all."""
    of = "levels" if "levels" in entry else "conditions"
    shared = {name: value for name, value in entry.items() if name != of}
    return [shared | {of[:-1]: one[of[:-1]]} | one for one in entry[of]]


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
