from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.report.content import Section
from analysis.report.sections.diagnostics import diagnostics_section
from analysis.report.sections.flow import flow_section
from analysis.report.sections.limits import limits_section
from analysis.report.sections.methods import methods_section
from analysis.report.sections.truth import truth_section
from analysis.results.known_values import KnownValue
from tests.analysis.report.made_reports import report_of, subject_of
from tests.analysis.results.made_tables import TABLES, catch_rows, pairwise_table


def words(section: Section | None) -> str:
    assert section is not None
    tables = [
        text
        for table in section.tables
        for text in (table.caption, *table.header, *(c.text for row in table.rows for c in row))
    ]
    return " ".join((section.heading, *section.paragraphs, *section.bullets, *tables))


def test_the_methods_text_says_what_was_done_and_with_what(tmp_path: Path) -> None:
    table = pd.concat([pairwise_table(participants=6), catch_rows("p00", "ll", (5, 5))])
    report = report_of(table, "pairwise", tmp_path, margin=0.1)

    text = words(methods_section(report, subject_of(report, notes=("A note.",), frozen=("face",))))

    for part in (
        "Of 6 participants who answered, 5 were analysed.",
        "failed more than 1 catch trial (1)",
        "Holm's method over 3 tests",
        "two one-sided tests against a margin of 0.1",
        "The videos held face still.",
        "1 segment of speech was used (1 speaker, 1 emotion, 4.00 s in all).",
        "Which fits [emotion] better?",
        "study with SHA-256 abc, seed 7",
        report.source.sha256,
        "A note.",
    ):
        assert part in text


@pytest.mark.parametrize("protocol", TABLES)
def test_every_protocol_has_its_method_its_diagnostics_and_its_limits(
    protocol: str, tmp_path: Path
) -> None:
    report = report_of(TABLES[protocol](participants=5, segments=4), protocol, tmp_path)
    subject = subject_of(report)

    texts = [
        words(section(report, subject))
        for section in (methods_section, diagnostics_section, limits_section, flow_section)
    ]

    assert "{" not in " ".join(texts)
    assert "nan" not in " ".join(texts).split()
    assert ("Kendall's W" if protocol == "ranking" else "Krippendorff's α") in texts[1]
    assert ("Side bias" in texts[1]) == (protocol in ("pairwise", "mismatch"))
    assert "One speaker tells nothing about other speakers." in texts[2]


def test_the_flow_adds_up(tmp_path: Path) -> None:
    table = pd.concat([pairwise_table(participants=6), catch_rows("p00", "ll", (5, 5))])
    report = report_of(table, "pairwise", tmp_path)

    flow, reasons = flow_section(report, subject_of(report)).tables  # type: ignore[union-attr]

    assert [cell.text for cell in flow.rows[0]] == ["all", "6", "1", "5"]
    assert [cell.text for cell in reasons.rows[0]] == ["p00", "2 catch trials failed"]


def test_a_rehearsals_truth_is_held_against_estimates_of_either_direction(tmp_path: Path) -> None:
    report = report_of(pairwise_table(("ours", "other"), effects=(1.0, 0.0)), "pairwise", tmp_path)
    share = report.results.comparisons[0].win_share  # type: ignore[union-attr]
    truth = tuple(
        KnownValue(
            about=about,
            question="emotion",
            measure="win_share",
            value=value,
            on_these_segments=value,
        )
        for about, value in (("ours-other", share.estimate), ("other-ours", share.estimate - 0.9))
    )

    section = truth_section((report,), subject_of(report, origin="rehearsal", truth=truth))

    assert section is not None
    [first, second] = [[cell.text for cell in row] for row in section.tables[0].rows]
    assert first[6] == "inside"
    assert second[6] == "outside"
    assert float(second[4]) == pytest.approx(1 - share.estimate, abs=0.005)
    assert "1 of 2 intervals contain theirs" in section.paragraphs[0]
    assert truth_section((report,), subject_of(report)) is None
