"""The part of the report that shows what was found, whatever the protocol."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from analysis.report.content import Picture, Section
from analysis.report.headline.preferences import mismatch_sections, pairwise_sections
from analysis.report.headline.rankings import ranking_sections
from analysis.report.headline.ratings import rating_sections
from analysis.report.subject import Subject
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport


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
