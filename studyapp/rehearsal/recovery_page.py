"""Writing the results of a rehearsal: its tables as CSV, and all of them on a short page."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from analysis.report.content import MARKS, Cell, Section, Table
from analysis.report.page import Page, render_page
from analysis.report.texts import table
from analysis.report.wording import labelled
from motion.files import write_frame, write_text
from studyapp.rehearsal.recovered import Recovery
from studyapp.rehearsal.recovery_words import (
    counts_in_words,
    exclusions_in_words,
    intervals_in_words,
    signs_in_words,
    unanswered_in_words,
)
from studyapp.rehearsal.simulation.population import DESCRIPTIONS
from studyapp.study.folder import StudyFolder

PAGE = "recovery.html"


def write_recovery(folder: StudyFolder, recovery: Recovery) -> Path:
    """Write page and tables into the rehearsal's folder and return the page."""
    for name, frame in recovery_tables(recovery).items():
        write_frame(folder.rehearsal_findings / name, frame)
    path = folder.rehearsal_findings / PAGE
    with labelled(recovery.labels):
        write_text(path, render_page(recovery_page(recovery)))
    return path


def recovery_page(recovery: Recovery) -> Page:
    """Return the page of a rehearsal's results."""
    mark, mark_short = MARKS["rehearsal"]
    return Page(
        title=f"What the rehearsal found: {recovery.title}",
        mark=mark,
        mark_short=mark_short,
        answer=(intervals_in_words(recovery), signs_in_words(recovery), counts_in_words(recovery)),
        picture=None,
        flow="",
        sections=_sections(recovery),
    )


def _sections(recovery: Recovery) -> tuple[Section, ...]:
    tables = recovery_tables(recovery)
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
            paragraphs=(signs_in_words(recovery),),
            bullets=tuple(unanswered_in_words(recovery)),
            tables=(table("truth_of_differences", recovery.differences),),
        ),
        Section(
            anchor="raters",
            heading="Who came, and who was left out",
            paragraphs=tuple(line.strip() for line in exclusions_in_words(recovery.kinds)),
            bullets=tuple(f"Rule: {rule}" for rule in recovery.rules),
            tables=(
                _table(
                    "Participants by kind. Missed: analysed although they should be excluded.",
                    tables["raters.csv"],
                    text_columns=2,
                    notes=(
                        "The clock of a rehearsal runs faster, and so counts the server's delays "
                        "several times: rules about time catch fewer here than in a study.",
                    ),
                ),
            ),
        ),
        Section(
            anchor="bookkeeping",
            heading="Whether everything was counted correctly",
            paragraphs=(counts_in_words(recovery),),
            tables=(
                _table(
                    "What happened, according to the simulated participants, and what the study "
                    "counted.",
                    tables["bookkeeping.csv"],
                    text_columns=1,
                ),
            ),
        ),
    )


def _table(
    caption: str, frame: pd.DataFrame, *, text_columns: int, notes: tuple[str, ...] = ()
) -> Table:
    """Return a table of counts; a column that says nothing is left out."""
    shown = frame.loc[:, [frame[name].astype(str).ne("").any() for name in frame]]
    return Table(
        caption=caption,
        header=tuple(str(name).replace("_", " ") for name in shown),
        rows=tuple(tuple(map(_cell, row)) for row in shown.itertuples(index=False, name=None)),
        text_columns=text_columns,
        notes=notes,
    )


def _cell(value: object) -> Cell:
    match value:
        case bool():
            return Cell(text="yes" if value else "NO")
        case int():
            return Cell(text=str(value), value=value)
        case _:
            return Cell(text=str(value).replace("_", " "))


VALUES = (
    *("part", "question", "measure", "about", "true_value", "true_value_on_these_segments"),
    *("found", "low", "high", "inside", "participants", "reason"),
)
DIFFERENCES = (
    *("part", "question", "measure", "first", "second", "true_value", "found", "low", "high"),
    *("sign", "participants", "reason"),
)


def recovery_tables(recovery: Recovery) -> dict[str, pd.DataFrame]:
    """Return every table under the name of its file."""
    return {
        "values.csv": _values(recovery),
        "differences.csv": _differences(recovery),
        "raters.csv": _raters(recovery),
        "bookkeeping.csv": pd.DataFrame(
            [vars(check) | {"agrees": check.agrees} for check in recovery.checks],
            columns=["what", "happened", "counted", "agrees", "remark"],
        ),
    }


def _values(recovery: Recovery) -> pd.DataFrame:
    rows = [
        vars(known)
        | vars(found)
        | {
            "true_value": known.value,
            "true_value_on_these_segments": known.on_these_segments,
            "found": found.estimate,
            "inside": found.covers(known.value) if found.has_interval else None,
        }
        for known, found in recovery.values
    ]
    return pd.DataFrame(rows, columns=VALUES)


def _differences(recovery: Recovery) -> pd.DataFrame:
    rows = [
        vars(each)
        | vars(each.estimate)
        | {"true_value": each.truth, "found": each.estimate.estimate, "sign": each.sign}
        for each in recovery.differences
    ]
    return pd.DataFrame(rows, columns=DIFFERENCES)


def _raters(recovery: Recovery) -> pd.DataFrame:
    rules = sorted({rule for kind in recovery.kinds for rule in kind.excluded_by})
    return pd.DataFrame(
        [
            {
                "kind": kind.kind,
                "description": DESCRIPTIONS[kind.kind],
                "came": kind.came,
                "completed": kind.completed,
                "no_answer": kind.silent,
                "analysed": kind.analysed,
                "excluded": kind.excluded,
                **{f"excluded_by_{rule}": kind.excluded_by.get(rule, 0) for rule in rules},
                "missed": kind.missed,
                "wrongly_excluded": kind.wrongly_excluded,
            }
            for kind in recovery.kinds
        ]
    )
