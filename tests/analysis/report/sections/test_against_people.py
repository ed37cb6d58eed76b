from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np

from analysis.answers.reading import read_answers
from analysis.answers.table import ANALYSED_KINDS, LAYOUTS
from analysis.metrics.scores import StudyMetrics
from analysis.report.content import Section
from analysis.report.sections.against_people import against_people_section, sampling_range_sentence
from analysis.report.subject import Subject
from analysis.results.against_people import metrics_against_people
from analysis.results.grouping import ByQuestion
from analysis.results.rank_correlations import sampling_range
from analysis.results.report import TableReport
from tests.analysis.results.made_tables import TABLES
from tests.analysis.results.simulated_studies import metrics_of

CONDITIONS = ("c00", "c01", "c02", "c03")


def report(  # What the section looks at, without the models that nothing here needs.
    folder: Path, *, protocol: str = "ranking", conditions: tuple[str, ...] = CONDITIONS
) -> SimpleNamespace:
    rows = TABLES[protocol](conditions=conditions, segments=8)
    rows["segment"] = rows["segment"].str.replace("s", "s0")
    rows.to_csv(folder / "answers.csv", index=False)
    table = read_answers(folder / "answers.csv", LAYOUTS[protocol])
    answers = table.shown[table.shown["kind"].isin(ANALYSED_KINDS)].reset_index(drop=True)
    return SimpleNamespace(
        protocol=protocol,
        sets=(),
        conditions_shown=table.conditions,
        metrics_against_people=metrics_against_people(
            table, answers, metrics(len(conditions)), "c00"
        ),
    )


def metrics(conditions: int) -> StudyMetrics:
    chance = np.random.default_rng(1)
    better = -np.arange(conditions)[:, None] + chance.normal(0, 0.1, (conditions, 8))
    return metrics_of(better)


def section(found: SimpleNamespace) -> Section | None:
    return against_people_section(
        cast(TableReport, found),
        Subject(
            title="study",
            origin="rehearsal",
            protocol=found.protocol,
            conditions=found.conditions_shown,
            questions={},
        ),
    )


def test_correlations_stand_in_a_table_and_two_figures_and_again_in_the_same_bytes(
    tmp_path: Path,
) -> None:
    found = report(tmp_path)
    shown = section(found)
    assert shown is not None
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
        assert "simulated raters" in picture.svg
        assert picture.figure is not None
    assert "c00" in shown.pictures[1].svg
    assert "With 4 conditions" in shown.paragraphs[0]


def test_the_fewer_the_conditions_the_less_they_are_said_to_tell(tmp_path: Path) -> None:
    many, few = (sampling_range_sentence(sampling_range(count)) for count in (10, 4))
    assert "anything from .07 to .82 in 95 of 100 studies" in many
    assert "could look the same" not in many
    assert "could look the same" in few
    shown = section(report(tmp_path, conditions=("c00", "c01")))
    assert shown is not None
    assert shown.paragraphs[0].startswith("Two conditions agree")
    assert any("2 conditions have scores" in note for note in shown.tables[0].notes)


def test_a_condition_without_a_score_is_named_under_the_table(tmp_path: Path) -> None:
    shown = section(report(tmp_path, protocol="pairwise", conditions=("c00", "c01", "z")))
    assert shown is not None
    notes = " ".join(shown.tables[0].notes)
    assert "Left out of liveliness: z (the metric was not measured)." in notes
    assert shown.tables[0].header[-1] == "pairs of clips"


def test_without_scores_a_sentence_says_so_and_without_metrics_there_is_no_section(
    tmp_path: Path,
) -> None:
    without = report(tmp_path, protocol="pairwise", conditions=("x", "y", "z"))
    shown = section(without)
    assert shown is not None
    assert shown.paragraphs[0].startswith("No metric has a score")
    assert not shown.tables
    without.metrics_against_people = ByQuestion()
    assert section(without) is None
