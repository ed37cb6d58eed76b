"""The page shows what the exclusions did to the results, and which of them were not planned."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analysis.answers.exclusion_rules import watched_less
from analysis.report.content import Section
from analysis.report.sections.participants import sensitivity_section
from analysis.results.pairwise import PairwiseResults
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import TABLES, pairwise_table, report_of


def section(folder: Path, protocol: str, *, below: float = 0.9) -> Section | None:
    """Return the section on a table where p01 watched half, which an exploratory rule minds."""
    table = TABLES[protocol](participants=5, segments=4)
    table["watched"] = np.where(table["participant"] == "p01", 0.5, 1)
    report = report_of(table, protocol, folder, exclude=[watched_less(below)])
    return sensitivity_section(report, subject_of(report))


@pytest.mark.parametrize("protocol", list(TABLES))
def test_all_three_groups_stand_side_by_side_where_a_rule_is_exploratory(
    tmp_path: Path, protocol: str
) -> None:
    found = section(tmp_path, protocol)
    assert found is not None
    [table] = found.tables
    assert [name for name, _ in table.groups[1:]] == ["analysed", "as planned", "nobody excluded"]
    for row in table.rows:
        assert len(row) == len(table.header)
        assert [row[place].text for place in (2, 4, 6)] == ["4", "5", "5"]
        assert row[4:6] == row[6:8]


def test_there_is_no_section_where_nobody_is_left_out(tmp_path: Path) -> None:
    assert section(tmp_path, "rating", below=0.1) is None


def test_as_planned_is_not_shown_where_it_is_what_is_analysed(tmp_path: Path) -> None:
    table = TABLES["ranking"](participants=5, segments=4)
    report = report_of(table.assign(excluded=table["participant"] == "p01"), "ranking", tmp_path)
    found = sensitivity_section(report, subject_of(report))
    assert found is not None
    assert [name for name, _ in found.tables[0].groups[1:]] == ["analysed", "nobody excluded"]


@pytest.mark.parametrize("reference", ["ours", "other"])
def test_pairs_are_seen_from_the_reference_as_in_the_headline(
    tmp_path: Path, reference: str
) -> None:
    table = pairwise_table(("ours", "other"), effects=(1.0, 0.0), participants=8)
    table["excluded"] = table["participant"] == table["participant"].iloc[0]
    report = report_of(table, "pairwise", tmp_path)

    found = sensitivity_section(report, subject_of(report, reference=reference))

    assert found is not None
    [[_, pair, _, share, *_]] = found.tables[0].rows
    assert isinstance(report.results, PairwiseResults)
    [comparison] = report.results.comparisons
    toward = comparison.win_share.estimate
    assert pair.text.startswith(reference)
    assert share.value == pytest.approx(toward if comparison.a == reference else 1 - toward)
