"""Writing a report: `results.json`, the page, tables and figures."""

from __future__ import annotations

import base64
import hashlib
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from analysis.measurement.score_tables import score_table
from analysis.report.booktabs import booktabs
from analysis.report.content import Cell, Page, Picture, Table
from analysis.report.page import TASKS, build_page
from analysis.report.sections.methods import ANCHOR
from analysis.report.sections.metric_table import SCORES
from analysis.report.subject import Subject
from analysis.results.report import TableReport, as_json, plain
from motion.files import replacing, write_text
from motion.spreadsheet import harmless_frame

FOLDERS = ("tables", "figures")

_PER_REPORT: Final = ("rules", "flow", "sensitivity")
"""Lists that every report has, beside what its protocol gives."""


def write_report(
    report: TableReport,
    subject: Subject,
    folder: Path,
    *,
    beside: Mapping[str, object] | None = None,
    more: tuple[TableReport, ...] = (),
) -> Path:
    """Write a report's files and return the page.

    Parameters
    ----------
    report : TableReport
        The results.
    subject : Subject
        What they are about.
    folder : Path
        Gets ``report.html``, which needs no other file; ``results.json``; ``tables`` with CSV and
        LaTeX; ``figures`` with PDF; ``paper.txt`` with sentences for a paper. What an earlier
        report left in the two folders is removed.
    beside : mapping of str to object, optional
        Further keys of ``results.json``.
    more : tuple of TableReport
        Results of further tasks of the same study, on the same page.
    """
    page = build_page(report, subject, more)
    for name in FOLDERS:
        shutil.rmtree(folder / name, ignore_errors=True)
    for name, table in csv_tables(report).items():
        write_frame(folder / "tables" / name, table)
    for task in more:
        for name, table in csv_tables(task).items():
            write_frame(folder / "tables" / f"{TASKS[task.protocol]}_{name}", table)
    if subject.metrics is not None:
        # Those of single clips are many; 'motionjury metrics' writes them.
        scores = score_table(replace(subject.metrics, clips=()))
        write_frame(folder / "tables" / SCORES, scores)
    write_page_files(page, folder)
    keys = report.keys() | {TASKS[task.protocol]: task.keys() for task in more} | dict(beside or {})
    write_text(folder / "results.json", as_json(keys))
    write_text(folder / "paper.txt", paper_text(page))
    path = folder / "report.html"
    write_text(path, render_page(page))
    return path


def paper_text(page: Page) -> str:
    """Return the answer, the participant flow and the methods, a paragraph each.

    Whatever must be said on every page, such as that nobody but simulated raters answered, comes
    first.
    """
    methods = [section for section in page.sections if section.anchor == ANCHOR]
    paragraphs = [
        *([page.mark] if page.mark else []),
        " ".join(page.answer),
        page.flow,
        *(text for section in methods for text in (*section.paragraphs, *section.bullets)),
    ]
    return "\n\n".join(paragraph for paragraph in paragraphs if paragraph) + "\n"


def render_page(page: Page) -> str:
    """Return the page as one HTML document."""
    environment = Environment(
        loader=PackageLoader("analysis.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    script = (files("analysis.report") / "templates" / "sorting.js").read_text("utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return environment.get_template("report.html").render(
        page=page,
        script=Markup(script),  # noqa: S704 - our own file
        script_hash=f"sha256-{digest}",
    )


def write_page_files(page: Page, folder: Path) -> None:
    """Write the page's named tables as LaTeX and CSV, and its named figures as PDF.

    Parameters
    ----------
    page : Page
        Names of its tables, and of its figures, are all different.
    folder : Path
        Gets ``tables`` and ``figures``.
    """
    for table in page_tables(page):
        if not table.name:
            continue
        remark = f"[{page.mark_short}]" if page.mark_short else ""
        write_text(folder / "tables" / f"{table.name}.tex", booktabs(table, remark=remark))
        if not table.data:
            write_frame(folder / "tables" / f"{table.name}.csv", as_frame(table))
    for picture in page_pictures(page):
        if picture.name and picture.pdf:
            with replacing(folder / "figures" / f"{picture.name}.pdf") as draft:
                draft.write_bytes(picture.pdf)


def page_tables(page: Page) -> Iterator[Table]:
    """Give every table of the page, in order."""
    for section in page.sections:
        yield from section.tables


def page_pictures(page: Page) -> Iterator[Picture]:
    """Give every figure of the page, in order."""
    if page.picture:
        yield page.picture
    for section in page.sections:
        yield from section.pictures


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


def csv_tables(report: TableReport) -> dict[str, pd.DataFrame]:
    """Return tables by file name: one row an entry, nested names joined by '_'."""
    results: Any = plain(report.keys())
    rules = [rule.rule for rule in report.rules]
    excluded = [{"participant": who, "reason": why} for who, why in results["exclusions"].items()]
    rows = {"exclusions": excluded}
    for name in (*_PER_REPORT, *vars(report.results)):
        if not isinstance(results[name], str):
            rows[name] = _rows_of(results[name], with_sets=bool(report.sets))
    beside = _rows_of(results["metrics_against_people"], with_sets=bool(report.sets))
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


def _rows_of(found: Any, *, with_sets: bool) -> list[dict[str, Any]]:
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
