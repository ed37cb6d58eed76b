import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pytest

from analysis.evaluators import feature_networks
from analysis.metrics.emotion_accuracy import emotion_confusion
from analysis.metrics.scores import (
    Better,
    ConditionScore,
    Metric,
    StudyMetrics,
    whole_condition,
)
from analysis.report.content import Table
from analysis.report.sections.metric_table import first_and_second
from analysis.report.sections.metrics import confusion_tables, metric_tables, metrics_not_tabled
from motion.errors import InputError
from tests.analysis.report.subjects import bare_subject

NAMES = ("ground_truth", "ours", "camn", "broken")
GEN = {"ours": True, "camn": False}


def scores(
    name: str,
    values: Iterable[float],
    *,
    better: Better = "lower",
    spread: float = math.nan,
    reason: str = "no recording",
    remark: str = "",
) -> list[ConditionScore]:
    metric, settings = Metric(name, better=better), {"frame_rate": "30 fps"}
    return [
        replace(
            whole_condition(
                condition,
                metric.missing(reason, settings)
                if math.isnan(value)
                else metric.score(value, 8, settings, remark=remark),
                8,
            ),
            spread=spread,
        )
        for condition, value in zip(NAMES, values, strict=True)
    ]


def tables(
    *found: list[ConditionScore], protocol: str = "ranking", **settings: Any
) -> tuple[Table, ...]:
    metrics = StudyMetrics(
        frame_rate=30.0, clips=(), conditions=tuple(s for own in found for s in own)
    )
    conditions = ("ours", "camn", "ground_truth")
    unranked = {"recorded": "ground_truth", "broken": "broken"}
    subject = bare_subject(protocol=protocol, conditions=conditions, **unranked, **settings)
    return metric_tables(metrics, protocol, subject)


def column(table: Table, heading: str) -> list[str]:
    place = table.header.index(heading)
    marks = [f"{'*' * row[place].best}{'_' * row[place].second}" for row in table.rows]
    return [f"{m}{row[place].text}" for m, row in zip(marks, table.rows, strict=True)]


def test_a_papers_table_has_its_columns_and_ranks_no_recorded_or_broken_motion() -> None:
    (table,) = tables(scores("beat alignment (beat)", [0.9, 0.8, 0.7, 0.95], better="higher"))
    assert table.groups == (("", 1), ("Holistic", 1), ("Expression", 2), ("Gesture", 5))
    assert table.header[:3] == ("condition", "FMD ↓", "FED ↓")
    assert table.name == "metrics-diffsheg"
    assert [row[0].text for row in table.rows] == ["ground truth", "ours", "camn", "broken"]
    assert column(table, "BA ↑") == ["0.900", "*0.800", "_0.700", "0.950"]


def test_nearness_is_measured_from_recorded_motion() -> None:
    jerk = scores("jerk (hands)", [100, 140, 90, 9000], better="near the reference", spread=11.0)
    (table,) = tables(jerk, protocol="pairwise")
    assert table.caption == "Automatic metrics."
    found = column(table, "jerk (hands) →")
    assert found[1].startswith("_140")
    assert found[2].startswith("*90")
    assert "standard deviation between clips" in table.notes[0]


def test_stated_generative_conditions_are_marked_in_diffshegs_blocks() -> None:
    own = scores("beat alignment (beat)", [0.9, 0.8, 0.7, 0.95])
    (table,) = tables(own, generative=GEN)
    assert table.header.count("Gen") == 2
    assert column(table, "Gen") == ["–", "✓", "✗", "–"]
    (without,) = tables(own)
    assert "Gen" not in without.header


def test_a_missing_score_is_a_dash_and_footnotes_give_reasons_and_remarks() -> None:
    (table,) = tables(scores(feature_networks.FMD, [math.nan, 3.0, 4.0, 5.0], reason="is itself"))
    assert column(table, "FMD ↓")[0] == "–\xa0(a)"
    assert table.rows[0][1].value is None
    assert "(a) holistic FMD of ground truth: is itself." in table.notes
    assert any("gesture PCM" in note and "not measured" in note for note in table.notes)
    fmd = scores(feature_networks.FMD, [1.0, 3.0, 4.0, 5.0], remark="n < 2d")[1:]
    (table,) = tables(fmd, scores("beat alignment (beat)", [0.9, 0.8, 0.7, 0.95]))
    notes = " ".join(table.notes)
    assert "of ground truth: recorded motion is not compared with itself." in notes
    assert "holistic FMD of ours, camn and broken: n < 2d." in notes


def test_other_metrics_follow_in_tables_that_fit_a_page_and_details_stay_in_the_files() -> None:
    paper, *others, missing = tables(
        scores(feature_networks.FMD, [1.0, 3.0, 4.0, 5.0]),
        scores("beat alignment by chance (beat)", [0.1, 0.1, 0.1, 0.1]),
        *(scores(f"metric {number}", [1.0, 2.0, 3.0, 4.0]) for number in range(8)),
        scores("new metric", [math.nan] * 4, reason="no network: train one"),
    )
    assert paper.name == "metrics-diffsheg"
    assert [name for table in others for name in table.header[1:]] == [
        f"metric {number} ↓" for number in range(8)
    ]
    assert [len(table.header) for table in others] == [5, 5]
    assert len({table.name for table in others}) == 2
    assert [cell.text for cell in missing.rows[0]] == ["new metric", "no network: train one"]


def test_missing_measurements_and_recognised_emotions_are_shown() -> None:
    named = ["neutral", "anger", "anger", "anger"]
    confusion = emotion_confusion(["anger"] * 4, named, named[:2], condition="ours", network="n")
    metrics = StudyMetrics(
        frame_rate=30.0,
        clips=(),
        conditions=(),
        skipped=(InputError("the file is cut off", where="/a/b/x.npz", remedy="Copy it"),),
        remarks=("no beat alignment without speech: 1 of 2 segments (a)",),
        confusions=(confusion,),
    )
    assert metrics_not_tabled(metrics) == (
        "No beat alignment without speech: 1 of 2 segments (a).",
        "Not used: x.npz: the file is cut off.",
    )
    (table,) = confusion_tables(metrics)
    assert column(table, "anger") == ["*3"]
    assert column(table, "neutral") == ["1"]


@pytest.mark.parametrize(
    ("scores", "better", "decimals", "best", "second"),
    [
        ([3.0, 1.0, 5.0, 9.0], "lower", 2, {1}, {0}),
        ([3.0, 1.0, 5.0, 9.0], "higher", 2, {3}, {2}),
        ([3.0, 1.0, 5.0, 9.0], "near the reference", 2, {2}, {0}),
        pytest.param([0.911, 0.912, 0.5, 0.4], "higher", 2, {0, 1}, {2}, id="as printed"),
        pytest.param([0.6, 0.4, 9.0], "near the reference", 0, {0, 2}, {1}, id="distance printed"),
        pytest.param([math.nan, 2.0, 3.0], "lower", 2, {1}, {2}, id="missing score"),
        pytest.param([2.0, 2.0, math.nan], "lower", 2, set(), set(), id="equal scores"),
        pytest.param([1.0, 2.0], "unsaid", 2, set(), set(), id="no direction"),
    ],
)
def test_the_best_and_the_second_best_scores_are_those_of_the_printed_numbers(
    scores: list[float], better: Better, decimals: int, best: set[int], second: set[int]
) -> None:
    assert first_and_second(scores, better, 4.9, decimals) == (best, second)
    assert first_and_second(scores[:1], better, 4.9, decimals) == (set(), set())
