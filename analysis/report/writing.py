"""Writing a report's files: page, tables, figures."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.report.content import Page
from analysis.report.findings import find
from analysis.report.inputs import ReportInputs
from analysis.report.latex_table import latex_table
from analysis.report.page import build_page
from analysis.report.tables import data_tables
from motion.files import replacing, write_text


def write_report(inputs: ReportInputs, folder: Path) -> Path:
    """Analyse a study and write its report.

    Parameters
    ----------
    inputs : ReportInputs
        Answers, motions and what the study asked.
    folder : Path
        Gets ``report.html``, which needs no other file, and ``tables`` with CSV and LaTeX.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If a motion or a recording cannot be read.
    """
    findings = find(inputs)
    page = build_page(inputs, findings)
    for name, table in data_tables(inputs, findings).items():
        with replacing(folder / "tables" / name) as draft:
            table.to_csv(draft, index=False, lineterminator="\n")
    if findings.preferences:
        write_text(folder / "tables" / "preferences.tex", latex_table(inputs, findings))
    path = folder / "report.html"
    write_text(path, render_page(page))
    return path


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
    return environment.get_template("report.html").render(page=page)
