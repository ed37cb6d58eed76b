"""The report: the order of its sections, and its files."""

from __future__ import annotations

import base64
import hashlib
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeVar, cast

import pandas as pd
from markupsafe import Markup

from analysis.report import wording
from analysis.report.content import Picture, PlayableMotion, Section, Subject, Table
from analysis.report.figures.style import FORMATS, as_file
from analysis.report.sections.answer import (
    METHODS_ANCHOR,
    answer,
    certainty,
    limits_section,
    methods_section,
)
from analysis.report.sections.conditions import condition_sections
from analysis.report.sections.heterogeneity import heterogeneity_section
from analysis.report.sections.participants import (
    diagnostics_section,
    flow_line,
    flow_section,
    looks_section,
    sensitivity_section,
    stills_section,
    truth_section,
)
from analysis.report.sections.preferences import preference_sections
from analysis.report.texts import booktabs, html, paragraphs, template_file
from analysis.results.grouping import ByQuestion
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.report import TableReport, as_json, plain
from motion.files import replacing, write_frame, write_text


def write_report(
    report: TableReport,
    subject: Subject,
    folder: Path,
    *,
    extra_keys: Mapping[str, object] | None = None,
    further_tasks: tuple[TableReport, ...] = (),
) -> Path:
    """Write a report's files and return the page.

    Parameters
    ----------
    report : TableReport
        The results.
    subject : Subject
        The subject of the report.
    folder : Path
        Receives ``report.html``, which needs no other file; ``results.json``; ``tables`` with CSV
        and LaTeX; ``figures`` with PDF, PNG and SVG; ``paper.txt`` with text for a paper. Tables
        and figures of an earlier report are removed.
    extra_keys : mapping of str to object, optional
        Further keys of ``results.json``.
    further_tasks : tuple of TableReport
        Results of further tasks of the same study, on the same page.
    """
    page = build_page(report, subject, further_tasks)
    for name in ("tables", "figures"):
        shutil.rmtree(folder / name, ignore_errors=True)
    for prefix, task in (
        ("", report),
        *((f"{TASKS[task.protocol]}_", task) for task in further_tasks),
    ):
        for name, table in csv_tables(task).items():
            write_frame(folder / "tables" / f"{prefix}{name}", table)
    write_page_files(page, folder)
    tasks = {TASKS[task.protocol]: task.keys() for task in further_tasks}
    results = report.keys() | tasks | dict(extra_keys or {})
    write_text(folder / "results.json", as_json(results))
    write_text(folder / "paper.txt", paper_text(page))
    path = folder / "report.html"
    write_text(path, render_page(page))
    return path


def report_table(results: TableReport, folder: Path) -> Path:
    """Write the report of a table from any platform and return its page; see `write_report`."""
    subject = Subject(
        title=f"Answers in {results.source.file}",
        origin="table",
        protocol=results.protocol,
        conditions=results.conditions_shown,
        questions=dict.fromkeys(results.questions, ""),
    )
    return write_report(results, subject, folder)


def paper_text(page: Page) -> str:
    """Return the page's mark, the answer, the participant flow and the methods as paragraphs."""
    methods = [section for section in page.sections if section.anchor == METHODS_ANCHOR]
    paragraphs = [
        page.mark,
        " ".join((*page.answer, *page.certainty)),
        page.flow,
        *(text for section in methods for text in (*section.paragraphs, *section.bullets)),
    ]
    return "\n\n".join(paragraph for paragraph in paragraphs if paragraph) + "\n"


def render_page(page: Page) -> str:
    """Return the page as one HTML document."""
    scripts = (template_file("page.js"), *(page.motion.scripts if page.motion else ()))
    return html(
        "report.html",
        page=page,
        scripts=[Markup(script) for script in scripts],  # noqa: S704 - our own files
        script_hashes=[
            f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"
            for script in scripts
        ],
        motion_style=Markup(page.motion.style if page.motion else ""),  # noqa: S704 - our own file
    )


def write_page_files(page: Page, folder: Path) -> None:
    """Write the page's named tables as LaTeX and CSV, and its named figures as PDF, PNG and SVG."""
    remark = f"[{page.mark_short}]" if page.mark_short else ""
    pictures = [page.picture] if page.picture else []
    pictures += [picture for section in page.sections for picture in section.pictures]
    for table in (table for section in page.sections for table in section.tables if table.name):
        write_text(folder / "tables" / f"{table.name}.tex", booktabs(table, remark=remark))
        if not table.data:
            write_frame(folder / "tables" / f"{table.name}.csv", as_frame(table))
    for picture in pictures:
        if picture.name and picture.figure is not None:
            for extension in FORMATS:
                with replacing(folder / "figures" / f"{picture.name}.{extension}") as draft:
                    draft.write_bytes(as_file(picture.figure, extension))


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


FiledT = TypeVar("FiledT", Picture, Table)

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
        | cast(Any, plain(row.result))
        for row in results.rows()
    ]


def _unnested(entry: Record) -> list[Record]:
    """Return a record for each level of an effect or each condition, with their shared values."""
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


@dataclass(frozen=True, kw_only=True)
class Page:
    """The whole report.

    Attributes
    ----------
    title : str
        The study's title.
    mark : str
        A warning for every screen and every printed page; empty for real answers.
    mark_short : str
        The same in a word or two, for the title and for files of tables.
    answer : tuple of str
        The answer to the study's question: a sentence before the first figure, and others after it.
    picture : Picture or None
        The first figure; None if nobody has answered.
    flow : str
        The participant flow in one line.
    sections : tuple of Section
        Everything after the first screen.
    certainty : tuple of str
        How sure the answer is, in sentences that the page folds away.
    motion : PlayableMotion or None
        The motions that play on the page.
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
"""Names of the tasks that a study has besides its main one, by protocol."""


def build_page(
    report: TableReport, subject: Subject, further_tasks: tuple[TableReport, ...] = ()
) -> Page:
    """Return everything that the template lays out; see `write_report`."""
    with wording.labelled(subject.labels, subject.mark):
        sections = [section for section in _sections(report, subject, further_tasks) if section]
        picture, sections = take_first_picture(sections)
        return Page(
            title=subject.title,
            mark=subject.mark,
            mark_short=subject.mark_short,
            answer=answer(report, subject),
            picture=picture,
            flow=flow_line(report, subject),
            sections=tuple(sections),
            certainty=certainty(report, subject),
            motion=subject.motion,
        )


def _sections(
    report: TableReport, subject: Subject, further_tasks: tuple[TableReport, ...]
) -> Iterator[Section | None]:
    yield flow_section(report, subject)
    yield from headline_sections(report, subject)
    for task in further_tasks:
        yield from map(partial(_of_task, task), headline_sections(task, subject))
    yield heterogeneity_section(report, subject)
    yield sensitivity_section(report, subject)
    for task in further_tasks:
        sensitivity = sensitivity_section(task, subject)
        yield sensitivity and _of_task(task, sensitivity)
    yield from _motion_sections(report, subject)
    yield diagnostics_section(report, subject)
    yield truth_section(subject)
    yield looks_section(report)
    yield methods_section(report, subject)
    yield limits_section(report, subject)


def _motion_sections(report: TableReport, subject: Subject) -> Iterator[Section | None]:
    if subject.metrics is None and subject.motion is None:
        nothing = paragraphs("metrics.nothing")
        yield Section(anchor="metrics", heading="Automatic metrics", paragraphs=nothing)
        yield stills_section(subject)
        return
    # Imported here: a table of answers has no motion, and needs nothing that describes it.
    from analysis.report.sections.against_people import against_people_section
    from analysis.report.sections.metrics import metric_section, played_pairs_section

    yield metric_section(report, subject)
    yield stills_section(subject)
    yield played_pairs_section(subject)
    yield against_people_section(report, subject)


def headline_sections(report: TableReport, subject: Subject) -> tuple[Section, ...]:
    """Return the protocol's figures and tables, a section for each set; () without answers."""
    results = report.results
    if isinstance(results, PairwiseResults | MismatchResults):
        return tuple(preference_sections(results, subject))
    return tuple(condition_sections(results, subject))


def take_first_picture(sections: Sequence[Section]) -> tuple[Picture | None, list[Section]]:
    """Return the first figure, for the first screen of the page, and the sections without it."""
    for place, section in enumerate(sections):
        if section.pictures:
            picture, *others = section.pictures
            without = replace(section, pictures=tuple(others))
            return picture, [*sections[:place], without, *sections[place + 1 :]]
    return None, list(sections)


def _of_task(task: TableReport, section: Section) -> Section:
    """Return a section with the task's name before its anchor, heading and file names."""
    name = TASKS[task.protocol]

    def renamed(item: FiledT) -> FiledT:
        return replace(
            item,
            name=f"{name}-{item.name}" if item.name else "",
            data=f"{name}_{item.data}" if item.data else "",
        )

    return replace(
        section,
        anchor=f"{name}-{section.anchor}",
        heading=f"{name.capitalize()}: {section.heading}",
        pictures=tuple(map(renamed, section.pictures)),
        tables=tuple(map(renamed, section.tables)),
    )
