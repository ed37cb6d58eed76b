"""A report's tables as files: CSV of all results, and LaTeX of any table for a paper."""

from __future__ import annotations

import tomllib
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import Any, Final, cast

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.report.content import Table
from analysis.report.texts import template_file
from analysis.results.grouping import ByQuestion
from analysis.results.report import TableReport, plain
from motion.files import harmless_frame, replacing

LONGEST: Final = 40
"""Rows up to which a table floats; a longer one breaks across pages."""


def booktabs(table: Table, *, remark: str = "") -> str:
    """Return a table as LaTeX that compiles whatever its cells contain.

    Parameters
    ----------
    table : Table
        The table; its best cells become bold, its second best underlined.
    remark : str, optional
        Put before the caption, for example that no person answered.
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
    return "\n".join([*_requirements(body, is_long=is_long), body])


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
    """Return text as LaTeX prints it, with every special character escaped."""
    return text.translate(_escapes())


@cache
def _escapes() -> dict[int, str]:
    return str.maketrans(tomllib.loads(template_file("latex.toml")))


def _requirements(body: str, *, is_long: bool) -> list[str]:
    """Return comments that name the packages the table needs."""
    packages = "booktabs,longtable" if is_long else "booktabs,graphicx"
    lines = [rf"% Needs \usepackage{{{packages}}} and \usepackage[T1]{{fontenc}}."]
    if "textquotesingle" in body:
        lines.append(r"% Needs \usepackage{textcomp} before LaTeX 2020.")
    if any(ord(character) > 0x17F for character in body):
        lines.append("% Some names need LuaLaTeX or XeLaTeX and a font that has their letters.")
    return lines


def as_frame(table: Table) -> pd.DataFrame:
    """Return a table's numbers, and the text of cells without a number."""
    groups = [label for label, span in table.groups for _ in range(span)]
    header = table.header
    if groups:
        header = tuple(f"{g} {h}".strip() for g, h in zip(groups, header, strict=True))
    return pd.DataFrame(
        [
            [cell.text if cell.value is None else float(f"{cell.value:.10g}") for cell in row]
            for row in table.rows
        ],
        columns=list(header),
    )


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a table as CSV in one step, with nothing that a spreadsheet runs as a formula."""
    with replacing(path) as draft:
        harmless_frame(frame).to_csv(draft, index=False, lineterminator="\n")


Record = dict[str, Any]
"""One row of a CSV file."""


def csv_tables(report: TableReport) -> dict[str, pd.DataFrame]:
    """Return all results as tables by file name: a row per entry, nested names joined by '_'."""
    keys, has_sets = report.keys(), bool(report.sets)
    records: dict[str, list[Record]] = {
        "exclusions": [
            {"participant": participant, "reason": reason}
            for participant, reason in report.exclusions.items()
        ]
    }
    for name in ("rules", "flow", "sensitivity", *vars(report.results)):
        if not isinstance(keys[name], str):
            records[name] = _records(keys[name], has_sets)
    records["metrics_against_people"] = [
        record
        for entry in _records(report.metrics_against_people, has_sets)
        for record in _records_of_metrics(entry)
    ]
    for name in {"heterogeneity", "bradley_terry", "plackett_luce"} & records.keys():
        records[name] = [record for entry in records[name] for record in _unnested(entry)]
    for flow in records["flow"]:
        counts = zip((rule.rule for rule in report.rules), flow.pop("removed"), strict=True)
        flow |= {f"removed_{place}_{rule}": n for place, (rule, n) in enumerate(counts, start=1)}
    return {
        f"{name}.csv": pd.json_normalize([_flat(record) for record in entries], sep="_")
        for name, entries in records.items()
        if entries
    }


def _records(results: Any, has_sets: bool) -> list[Record]:
    """Return a list of results, or results by question, as records."""
    if not isinstance(results, ByQuestion):
        return [*cast(Any, plain(results))]
    return [
        ({"set": row.set} if has_sets else {})
        | {"question": row.question}
        | cast(Any, plain(row.found))
        for row in results.rows()
    ]


def _unnested(entry: Record) -> list[Record]:
    """Return a record for each level of an effect or each condition, with what they share."""
    plural = "levels" if "levels" in entry else "conditions"
    singular = plural[:-1]
    shared = {name: value for name, value in entry.items() if name != plural}
    return [shared | {singular: nested[singular]} | nested for nested in entry[plural]]


def _records_of_metrics(entry: Record) -> list[Record]:
    """Return a record for each metric compared with the answers to a question."""
    question = {name: entry[name] for name in ("set", "question") if name in entry}
    return [
        question | {name: metric[name] for name in metric if name not in ("left_out", "places")}
        for metric in entry["metrics"]
    ]


def _flat(record: Record) -> Record:
    """Join lists of numbers or words in one cell, and drop lists of results."""
    flat: Record = {}
    for name, value in record.items():
        if isinstance(value, dict):
            flat[name] = _flat(value)
        elif not isinstance(value, list):
            flat[name] = value
        elif not any(isinstance(item, dict) for item in value):
            flat[name] = "; ".join(map(str, value))
    return flat
