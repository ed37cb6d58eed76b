"""Writing what came of a rehearsal: a short page, and its tables as CSV."""

from __future__ import annotations

import math
from pathlib import Path

from analysis.report.content import Cell, Page, Section, Table, cells
from analysis.report.table_files import write_frame
from analysis.report.wording import fixed
from analysis.report.writing import render_page
from analysis.results.known_values import KnownDifference
from analysis.stats.clustered_mean import Estimate
from motion.files import write_text
from studyapp.rehearsal.recovery.recovery import Recovery
from studyapp.rehearsal.recovery.tables import recovery_tables
from studyapp.rehearsal.recovery.words import (
    counts_in_words,
    difference_in_words,
    exclusions_in_words,
    intervals_in_words,
    named,
    signs_in_words,
)
from studyapp.rehearsal.simulation.kinds import DESCRIPTIONS
from studyapp.study.folder import StudyFolder

PAGE = "recovery.html"


def write_recovery(folder: StudyFolder, recovery: Recovery) -> Path:
    """Write page and tables into the rehearsal's folder and return the page."""
    for name, table in recovery_tables(recovery).items():
        write_frame(folder.rehearsal_findings / name, table)
    path = folder.rehearsal_findings / PAGE
    write_text(path, render_page(recovery_page(recovery)))
    return path


def recovery_page(recovery: Recovery) -> Page:
    """Return the page that says what came of a rehearsal."""
    return Page(
        title=f"{recovery.title}: what the rehearsal found",
        mark="Rehearsal: simulated raters, no person answered",
        mark_short="rehearsal",
        answer=(intervals_in_words(recovery), signs_in_words(recovery), counts_in_words(recovery)),
        picture=None,
        flow="",
        sections=(
            _values(recovery),
            _differences(recovery),
            _raters(recovery),
            _bookkeeping(recovery),
        ),
    )


def _values(recovery: Recovery) -> Section:
    return Section(
        anchor="values",
        heading="What was put in, and what the analysis finds",
        paragraphs=(
            "Put in is what very many attentive raters would say of all segments such as these. "
            "Others answer too, as they do in studies, so that what they blur is blurred here.",
        ),
        tables=(
            Table(
                caption="Each number that was put in, and its estimate after exclusions.",
                header=(
                    "question",
                    "of",
                    "number",
                    "put in",
                    "found",
                    "95 % interval",
                    "put in is",
                ),
                rows=tuple(
                    (
                        *cells(_question(known.part, known.question), known.about),
                        Cell(text=known.measure.replace("_", " ")),
                        Cell(text=fixed(known.value, 2), value=known.value),
                        Cell(text=fixed(found.estimate, 2), value=found.estimate),
                        Cell(text=_interval(found)),
                        Cell(text=_where(found, known.value)),
                    )
                    for known, found in recovery.values
                ),
                text_columns=3,
            ),
        ),
    )


def _differences(recovery: Recovery) -> Section:
    return Section(
        anchor="differences",
        heading="Which is the better one",
        paragraphs=(signs_in_words(recovery),),
        bullets=tuple(
            difference_in_words(each)
            for each in recovery.differences
            if each.sign in ("undecided", "wrong")
        ),
        tables=(
            Table(
                caption="How much better the first is than the second: of shares from one half, "
                "of ranks how much further in front.",
                header=("question", "first", "second", "put in", "found", "95 % interval", "sign"),
                rows=tuple(_difference(each) for each in recovery.differences),
                text_columns=3,
            ),
        ),
    )


def _difference(each: KnownDifference) -> tuple[Cell, ...]:
    return (
        *cells(_question(each.part, each.question), each.first, each.second),
        Cell(text=fixed(each.truth, 2), value=each.truth),
        Cell(text=fixed(each.found.estimate, 2), value=each.found.estimate),
        Cell(text=_interval(each.found)),
        Cell(text=each.sign),
    )


def _raters(recovery: Recovery) -> Section:
    rules = sorted({rule for kind in recovery.kinds for rule in kind.excluded_by})
    return Section(
        anchor="raters",
        heading="Who came, and who was left out",
        paragraphs=tuple(line.strip() for line in exclusions_in_words(recovery.kinds)),
        bullets=tuple(f"Rule: {rule}" for rule in recovery.rules),
        tables=(
            Table(
                caption="Participants by kind. Who is analysed and should not be is missed.",
                header=(
                    *("kind", "who", "came", "completed", "no answer", "analysed"),
                    *(f"by {rule}" for rule in rules),
                    *("missed", "wrongly left out"),
                ),
                rows=tuple(
                    (
                        *cells(named(kind.kind), DESCRIPTIONS[kind.kind]),
                        *(
                            Cell(text=str(count), value=count)
                            for count in (
                                *(kind.came, kind.completed, kind.silent, kind.analysed),
                                *(kind.excluded_by.get(rule, 0) for rule in rules),
                                *(kind.missed, kind.wrongly_excluded),
                            )
                        ),
                    )
                    for kind in recovery.kinds
                ),
                text_columns=2,
                notes=(
                    "Times in a rehearsal are those of its clock, which runs faster, the server's "
                    "own delays included: rules about time find fewer here than in a study.",
                ),
            ),
        ),
    )


def _bookkeeping(recovery: Recovery) -> Section:
    return Section(
        anchor="bookkeeping",
        heading="Whether all was counted right",
        paragraphs=(counts_in_words(recovery),),
        tables=(
            Table(
                caption="What happened, as the simulated participants know it, and what the study "
                "counts.",
                header=("what", "happened", "counted", "right", "remark"),
                rows=tuple(
                    (
                        Cell(text=check.what),
                        Cell(text=str(check.happened), value=check.happened),
                        Cell(text=str(check.counted), value=check.counted),
                        Cell(text="yes" if check.agrees else "NO"),
                        Cell(text=check.remark),
                    )
                    for check in recovery.checks
                ),
            ),
        ),
    )


def _question(part: str, question: str) -> str:
    return f"{part}: {question}" if part else question


def _interval(found: Estimate) -> str:
    if math.isnan(found.low):
        return found.reason or "none"
    return f"[{fixed(found.low, 2)}, {fixed(found.high, 2)}]"


def _where(found: Estimate, value: float) -> str:
    if not found.has_interval:
        return "no interval"
    return "inside" if found.covers(value) else "outside"
