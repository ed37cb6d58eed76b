"""Writing what a table of answers says: `results.json`, a page, and tables."""

from __future__ import annotations

from pathlib import Path

from analysis.report.writing import render_page
from analysis.results.csv_tables import csv_tables
from analysis.results.page import table_page
from analysis.results.plain import as_json
from analysis.results.report import TableReport
from motion.files import replacing, write_text


def write_table_report(report: TableReport, folder: Path) -> Path:
    """Write ``results.json``, ``report.html`` and ``tables/*.csv``, and return the page.

    Parameters
    ----------
    report : TableReport
        The results.
    folder : Path
        Made where it does not exist.
    """
    for name, table in csv_tables(report).items():
        with replacing(folder / "tables" / name) as draft:
            table.to_csv(draft, index=False, lineterminator="\n")
    write_text(folder / "results.json", as_json(report.keys()))
    page = folder / "report.html"
    write_text(page, render_page(table_page(report)))
    return page
