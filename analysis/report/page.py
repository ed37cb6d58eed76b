"""The report: its sections in order, and its files: results.json, the page, tables, figures."""

from __future__ import annotations

import base64
import hashlib
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from analysis.measurement.score_tables import score_table
from analysis.report import wording
from analysis.report.content import Picture, Section, Table
from analysis.report.figures.style import FORMATS, as_file
from analysis.report.sections.against_people import against_people_section
from analysis.report.sections.answer import (
    ANCHOR,
    answer,
    certainty,
    limits_section,
    methods_section,
)
from analysis.report.sections.heterogeneity import heterogeneity_section
from analysis.report.sections.metric import metric_section
from analysis.report.sections.metric_table import SCORES
from analysis.report.sections.participants import (
    diagnostics_section,
    flow_line,
    flow_section,
    looks_section,
    sensitivity_section,
    strip_section,
    truth_section,
)
from analysis.report.sections.played_pairs import played_pairs_section
from analysis.report.sections.preferences import mismatch_sections, pairwise_sections
from analysis.report.sections.rankings import ranking_sections
from analysis.report.sections.ratings import rating_sections
from analysis.report.subject import PlayableMotion, Subject
from analysis.report.tables import as_frame, booktabs, csv_tables, write_frame
from analysis.report.texts import template
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport, as_json
from motion.files import replacing, write_text

FOLDERS = ("tables", "figures")


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
        LaTeX; ``figures`` with PDF, PNG and SVG; ``paper.txt`` with sentences for a paper. What
        an earlier report left in the two folders is removed.
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
        " ".join((*page.answer, *page.certainty)),
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
    own = template("page.js")
    scripts = (own, *(page.motion.scripts if page.motion else ()))
    return environment.get_template("report.html").render(
        page=page,
        scripts=[Markup(script) for script in scripts],  # noqa: S704 - our own files
        script_hashes=[
            f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"
            for script in scripts
        ],
        motion_style=Markup(page.motion.style if page.motion else ""),  # noqa: S704 - our own file
    )


def write_page_files(page: Page, folder: Path) -> None:
    """Write the page's named tables as LaTeX and CSV, and its named figures as PDF, PNG and SVG.

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
        if picture.name and picture.figure is not None:
            for ending in FORMATS:
                with replacing(folder / "figures" / f"{picture.name}.{ending}") as draft:
                    draft.write_bytes(as_file(picture.figure, ending))


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


@dataclass(frozen=True, kw_only=True)
class Page:
    """The whole report.

    Attributes
    ----------
    title : str
        The study's title.
    mark : str
        What must be said on every screen and every printed page; empty for real answers.
    mark_short : str
        The same in a word or two, for the title, and for tables that leave the page.
    answer : tuple of str
        The sentences that answer the study's question: one before the first figure, the others
        after it.
    picture : Picture or None
        The first figure; None where nobody has answered.
    flow : str
        The participant flow in one line.
    sections : tuple of Section
        Everything after the first screen.
    certainty : tuple of str
        Sentences on how sure the answer is, which the page folds away.
    motion : PlayableMotion or None
        What plays on the page.
    """

    title: str
    mark: str
    mark_short: str
    answer: tuple[str, ...]
    picture: Picture | None
    flow: str
    sections: tuple[Section, ...]
    certainty: tuple[str, ...] = ()
    motion: PlayableMotion | None = None


TASKS: Final = MappingProxyType({"pairwise": "realism"})
"""What the tasks are called that a study has beside the one it is named after."""


def build_page(report: TableReport, subject: Subject, more: tuple[TableReport, ...] = ()) -> Page:
    """Return everything that the template lays out.

    Parameters
    ----------
    report : TableReport
        The results.
    subject : Subject
        What they are about.
    more : tuple of TableReport
        Results of further tasks of the same study.
    """
    with wording.labelled(subject.labels):
        sections = tuple(section for section in _sections(report, subject, more) if section)
        picture, rest = first_picture(sections)
        return Page(
            title=subject.title,
            mark=subject.mark,
            mark_short=subject.mark_short,
            answer=answer(report, subject),
            picture=picture,
            flow=flow_line(report, subject),
            sections=rest,
            certainty=certainty(report, subject),
            motion=subject.motion,
        )


def _sections(
    report: TableReport, subject: Subject, more: tuple[TableReport, ...]
) -> Iterator[Section | None]:
    yield flow_section(report, subject)
    yield from headline_sections(report, subject)
    for task in more:
        yield from map(partial(_of_task, task), headline_sections(task, subject))
    yield heterogeneity_section(report, subject)
    yield sensitivity_section(report, subject)
    for task in more:
        further = sensitivity_section(task, subject)
        yield further and _of_task(task, further)
    yield metric_section(report, subject)
    yield strip_section(subject)
    yield played_pairs_section(subject)
    yield against_people_section(report, subject)
    yield diagnostics_section(report, subject)
    yield truth_section((report, *more), subject)
    yield looks_section(report)
    yield methods_section(report, subject)
    yield limits_section(report, subject)


def headline_sections(report: TableReport, subject: Subject) -> tuple[Section, ...]:
    """Return the protocol's figures and tables, a section for each set; () without any answers.

    Parameters
    ----------
    report : TableReport
        What was found.
    subject : Subject
        What it is about.
    """
    match report.results:
        case PairwiseResults() as pairs:
            return pairwise_sections(pairs, subject)
        case MismatchResults() as matched:
            return mismatch_sections(matched, subject)
        case RatingResults() as rated:
            return rating_sections(rated, subject)
        case RankingResults() as ranked:
            return ranking_sections(ranked, subject)


def first_picture(sections: Sequence[Section]) -> tuple[Picture | None, tuple[Section, ...]]:
    """Take the first figure out of its section, for the first screen of the page.

    Returns
    -------
    (Picture or None, tuple of Section)
        The figure, None where there is none; and all sections without it.
    """
    for place, section in enumerate(sections):
        if section.pictures:
            rest = replace(section, pictures=section.pictures[1:])
            return section.pictures[0], (*sections[:place], rest, *sections[place + 1 :])
    return None, tuple(sections)


def _of_task(task: TableReport, section: Section) -> Section:
    """Tell a further task's section from those of the main one, and its files from theirs."""
    name = TASKS[task.protocol]
    return replace(
        section,
        anchor=f"{name}-{section.anchor}",
        heading=f"{name.capitalize()}: {section.heading}",
        pictures=tuple(
            replace(picture, name=f"{name}-{picture.name}", data=_task_data(task, picture.data))
            for picture in section.pictures
        ),
        tables=tuple(
            replace(
                table,
                name=f"{name}-{table.name}" if table.name else "",
                data=_task_data(task, table.data),
            )
            for table in section.tables
        ),
    )


def _task_data(task: TableReport, name: str) -> str:
    return f"{TASKS[task.protocol]}_{name}" if name else ""
