"""The results of a rehearsal: in sentences, and all of them on a short page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from analysis.report import wording
from analysis.report.content import MARKS, Section
from analysis.report.page import Page, render_page
from analysis.report.texts import paragraphs, table
from motion.files import write_text
from studyapp.rehearsal.recovered import Recovery
from studyapp.rehearsal.simulation.population import DESCRIPTIONS
from studyapp.study.folder import StudyFolder


def _words(macro: str, recovery: Recovery) -> tuple[str, ...]:
    return paragraphs(macro, recovery=recovery)


def values_in_words(recovery: Recovery) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """Return heading and rows of the page's table of true values, without its last column."""
    with wording.labelled(recovery.labels):
        values = table("truth", recovery.values)
    return values.header[:-1], [[cell.text for cell in row[:-1]] for row in values.rows]


def recovery_lines(recovery: Recovery) -> list[str]:
    """Return sentences about everything but the single values."""
    with wording.labelled(recovery.labels):
        exclusion, *kinds = _words("rehearsal.exclusions", recovery)
        return [
            *_words("rehearsal.intervals", recovery),
            *_words("rehearsal.signs", recovery),
            *(f"  {line}" for line in _words("rehearsal.unanswered", recovery)),
            exclusion,
            *(f"  {line}" for line in kinds),
            *_words("rehearsal.counts", recovery),
        ]


PAGE: Final = "recovery.html"


def write_recovery(folder: StudyFolder, recovery: Recovery) -> Path:
    """Write the page into the rehearsal's folder and return its path."""
    path = folder.rehearsal_findings / PAGE
    with wording.labelled(recovery.labels):
        write_text(path, render_page(recovery_page(recovery)))
    return path


def recovery_page(recovery: Recovery) -> Page:
    """Return the page of a rehearsal's results."""
    mark, mark_short = MARKS["rehearsal"]
    return Page(
        title=f"What the rehearsal found: {recovery.title}",
        mark=mark,
        mark_short=mark_short,
        answer=(
            *_words("rehearsal.intervals", recovery),
            *_words("rehearsal.signs", recovery),
            *_words("rehearsal.counts", recovery),
        ),
        picture=None,
        flow="",
        sections=_sections(recovery),
    )


def _sections(recovery: Recovery) -> tuple[Section, ...]:
    rules = sorted({rule for kind in recovery.kinds for rule in kind.excluded_by})
    return (
        Section(
            anchor="values",
            heading="True values, and what the analysis finds",
            paragraphs=(
                "The true value is what a very large number of attentive raters would say about "
                "all segments like these. Inattentive raters answer too, as they do in studies, "
                "and blur the estimates as they would there.",
            ),
            tables=(table("truth", recovery.values),),
        ),
        Section(
            anchor="differences",
            heading="Which condition is better",
            paragraphs=_words("rehearsal.signs", recovery),
            bullets=_words("rehearsal.unanswered", recovery),
            tables=(table("truth_of_differences", recovery.differences),),
        ),
        Section(
            anchor="raters",
            heading="Who came, and who was left out",
            paragraphs=_words("rehearsal.exclusions", recovery),
            bullets=tuple(f"Rule: {rule}" for rule in recovery.rules),
            tables=(
                table("rehearsed_kinds", recovery.kinds, rules=rules, descriptions=DESCRIPTIONS),
            ),
        ),
        Section(
            anchor="bookkeeping",
            heading="Whether everything was counted correctly",
            paragraphs=_words("rehearsal.counts", recovery),
            tables=(table("bookkeeping", recovery.checks),),
        ),
    )
