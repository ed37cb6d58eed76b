"""Turning results into a page, apart from how the page looks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Final

from analysis.report.content import Page, Picture, Section
from analysis.report.headline.heterogeneity import heterogeneity_section
from analysis.report.headline.preferences import mismatch_sections, pairwise_sections
from analysis.report.headline.rankings import ranking_sections
from analysis.report.headline.ratings import rating_sections
from analysis.report.sections.against_people import against_people_section
from analysis.report.sections.answer import answer
from analysis.report.sections.diagnostics import diagnostics_section
from analysis.report.sections.flow import flow_line, flow_section
from analysis.report.sections.limits import limits_section
from analysis.report.sections.looks import looks_section
from analysis.report.sections.methods import methods_section
from analysis.report.sections.metric import metric_section
from analysis.report.sections.sensitivity import sensitivity_section
from analysis.report.sections.strip import strip_section
from analysis.report.sections.truth import truth_section
from analysis.report.subject import Subject
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport

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
        case PairwiseResults() as results:
            return pairwise_sections(results, subject) if results.comparisons else ()
        case MismatchResults() as results:
            return mismatch_sections(results, subject) if results.conditions else ()
        case RatingResults() as results:
            return rating_sections(results, subject) if results.conditions else ()
        case RankingResults() as results:
            return ranking_sections(results, subject) if results.conditions else ()


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
            replace(picture, name=f"{name}-{picture.name}", data=_data(task, picture.data))
            for picture in section.pictures
        ),
        tables=tuple(
            replace(
                table,
                name=f"{name}-{table.name}" if table.name else "",
                data=_data(task, table.data),
            )
            for table in section.tables
        ),
    )


def _data(task: TableReport, name: str) -> str:
    return f"{TASKS[task.protocol]}_{name}" if name else ""
