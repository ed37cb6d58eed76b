from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.answers.participants import leave_out
from analysis.report.content import Section
from analysis.report.figures.style import FORMATS, as_file
from analysis.report.sections.against_people import against_people_section, sampling_range_sentence
from analysis.results.against_people import metrics_against_people
from analysis.results.grouping import ByQuestion
from analysis.results.rank_correlations import sampling_range
from analysis.results.report import TableReport
from tests.analysis.report.sections.reading import present
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import TABLES, read_table, report_of
from tests.analysis.results.simulated_studies import metrics_of

CONDITIONS = ("c00", "c01", "c02", "c03")


def report(folder: Path, protocol: str, conditions: Sequence[str]) -> TableReport:
    """Return results with one metric, of which the conditions called c… have scores."""
    rows = TABLES[protocol](conditions=conditions, segments=8)
    rows["segment"] = "s0" + rows["segment"].str[1:]
    table = read_table(rows, protocol, folder)
    noise = np.random.default_rng(1).normal(0, 0.1, (len(conditions), 8))
    metrics = metrics_of(noise - np.arange(len(conditions))[:, None])
    agreement = metrics_against_people(table, leave_out(table, ()).analysed, metrics, "c00")
    return replace(report_of(rows, protocol, folder), metrics_against_people=agreement)


def section(found: TableReport) -> Section | None:
    return against_people_section(found, subject_of(found))


def test_correlations_are_in_a_table_and_two_reproducible_figures(tmp_path: Path) -> None:
    found = report(tmp_path, "ranking", CONDITIONS)
    shown = present(section(found))
    assert shown == section(found)
    (table,) = shown.tables
    cells = [cell.text for cell in table.rows[0]]
    assert cells[:5] == ["Realism", "liveliness ↑", "4", "1", "[−.19,\xa01]"]
    assert table.name == "metrics-against-people"
    assert [picture.name for picture in shown.pictures] == [
        "metric-correlations",
        "metrics-against-people-1",
    ]
    for picture in shown.pictures:
        assert picture.figure
        assert all(len(as_file(picture.figure, extension)) > 1000 for extension in FORMATS)
    assert "c00" in shown.pictures[1].svg
    assert "With 4 conditions" in shown.paragraphs[0]


def test_fewer_conditions_give_a_weaker_statement(tmp_path: Path) -> None:
    many, few = (sampling_range_sentence(sampling_range(count)) for count in (10, 4))
    assert "anything from .07 to .82 in 95 of 100 studies" in many
    assert "could look the same" not in many
    assert "could look the same" in few
    shown = present(section(report(tmp_path, "ranking", ("c00", "c01"))))
    assert shown.paragraphs[0].startswith("Two conditions agree")
    assert any("2 conditions have scores" in note for note in shown.tables[0].notes)


def test_a_condition_without_a_score_is_named_under_the_table(tmp_path: Path) -> None:
    shown = present(section(report(tmp_path, "pairwise", ("c00", "c01", "z"))))
    notes = " ".join(shown.tables[0].notes)
    assert "Left out of liveliness: z (the metric was not measured)." in notes
    assert shown.tables[0].header[-1] == "pairs of clips"
    # Two conditions have scores, which is too few for a correlation over conditions.
    assert shown.paragraphs[0].startswith("Two conditions agree")
    (forest,) = shown.pictures
    assert "Within conditions" in forest.svg
    assert "Over conditions" not in forest.svg


def test_without_scores_a_sentence_says_so_and_without_metrics_there_is_no_section(
    tmp_path: Path,
) -> None:
    without = report(tmp_path, "pairwise", ("x", "y", "z"))
    shown = present(section(without))
    assert shown.paragraphs[0].startswith("No metric has a score")
    assert not shown.tables
    assert section(replace(without, metrics_against_people=ByQuestion())) is None
