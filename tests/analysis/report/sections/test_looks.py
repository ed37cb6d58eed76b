from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from analysis.report.sections.answer import answer
from analysis.report.sections.looks import MOST, looks_section
from analysis.report.sections.methods import methods_section
from analysis.results.looks import Look, looks_before
from tests.analysis.report.made_reports import report_of, subject_of
from tests.analysis.results.made_tables import pairwise_table

SENTENCE = "Results were looked at 2 times before these answers were complete, at 2 and 4 finished"


def looked(finished: int, reason: str = "a video broke") -> Look:
    return Look(
        day="2026-05-04",
        by="researcher 1",
        way="page",
        reason=reason,
        finished=finished,
        planned=30,
        answers=10 * finished,
    )


def test_looks_are_told_on_the_first_screen_in_the_methods_and_in_a_section(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=6), "pairwise", tmp_path)
    before = looks_before([looked(2), looked(4, "")], finished=6, answers=60)
    seen = replace(report, looks=before)

    section = looks_section(seen)

    assert section is not None
    assert section.paragraphs[0].startswith(SENTENCE)
    assert (
        f"in {100 * before.false_positive_rate:.1f} % of cases instead of 5 %"
        in (section.paragraphs[1])
    )
    [table] = section.tables
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["2026-05-04", "researcher 1", "researchers' page", "a video broke", "2", "30", "1"],
        ["2026-05-04", "researcher 1", "researchers' page", "not said", "4", "30", "1"],
    ]
    subject = subject_of(seen)
    assert SENTENCE in " ".join(answer(seen, subject))
    assert SENTENCE in " ".join(methods_section(seen, subject).paragraphs)
    assert looks_section(report) is None
    assert "looked at" not in " ".join(answer(report, subject))


def test_many_looks_are_counted_and_the_last_ones_shown(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=6), "pairwise", tmp_path)
    many = [looked(number) for number in range(1, MOST + 51)]
    seen = replace(report, looks=looks_before(many, finished=999, answers=9990))

    section = looks_section(seen)

    assert section is not None
    assert (
        f"{MOST + 50} numbers of finished participants from 1 to {MOST + 50}"
        in (section.paragraphs[0])
    )
    assert len(section.tables[0].rows) == MOST
    assert f"The last {MOST} rows of {MOST + 50}" in section.tables[0].notes[1]
