from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from pyarrow import parquet

from analysis.measurement.score_tables import (
    COLUMNS,
    check_ending,
    metrics_document,
    score_table,
    write_scores,
)
from analysis.measurement.scores import ClipScore, ConditionScore, SkippedFile, StudyMetrics
from analysis.metrics.result import EmotionConfusion, MetricResult
from motion.errors import InputError


@pytest.fixture
def metrics() -> StudyMetrics:
    """Return scores of one condition, of which one is missing."""
    settings = {"joints": "left_wrist, right_wrist"}
    found = MetricResult(
        name="jerk", value=1.5, unit="m/s³", n=40, settings=settings, better="near the reference"
    )
    missing = MetricResult(name="beat alignment", value=math.nan, unit="", n=0, reason="no beat")
    return StudyMetrics(
        frame_rate=30.0,
        clips=tuple(
            ClipScore(condition="ours", segment="a", result=result) for result in (found, missing)
        ),
        conditions=(
            ConditionScore(
                condition="ours",
                name="jerk",
                unit="m/s³",
                value=1.5,
                spread=math.nan,
                scored=1,
                clips=1,
                settings=settings,
                reason="",
            ),
        ),
        skipped=(SkippedFile(what="damaged", where="b.npz", remedy="Copy it again"),),
        confusions=(
            EmotionConfusion(
                condition="ours",
                network="abc",
                spoken=("anger",),
                named=("anger", "fear"),
                counts=((2, 1),),
            ),
        ),
    )


def test_conditions_come_first_and_have_no_segment(metrics: StudyMetrics) -> None:
    table = score_table(metrics)
    assert tuple(table.columns) == COLUMNS
    assert table["segment"].tolist() == ["", "a", "a"]
    assert table["clips"].isna().tolist() == [False, True, True]
    assert table["n"].isna().tolist() == [True, False, False]


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_tables_are_read_back_as_they_were(
    metrics: StudyMetrics, tmp_path: Path, ending: str
) -> None:
    path = tmp_path / f"scores.{ending}"
    write_scores(metrics, path)
    read = pd.read_csv(path) if ending == "csv" else pd.read_parquet(path)
    assert read["value"].tolist()[:2] == [1.5, 1.5]
    assert math.isnan(read["value"][2])
    assert read["reason"][2] == "no beat"
    assert read["unit"][0] == "m/s³"


def test_json_holds_no_nan_and_names_skipped_files(metrics: StudyMetrics, tmp_path: Path) -> None:
    path = tmp_path / "scores.json"
    write_scores(metrics, path)
    found = json.loads(path.read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert found["frame_rate"] == 30
    assert found["clips"][1] == {
        "condition": "ours",
        "segment": "a",
        "metric": "beat alignment",
        "value": None,
        "better": "unsaid",
        "n": 0,
        "reason": "no beat",
    }
    assert found["skipped"][0]["file"] == "b.npz"


def test_two_writings_are_the_same_bytes(metrics: StudyMetrics, tmp_path: Path) -> None:
    for ending in ("csv", "json", "parquet"):
        paths = [tmp_path / f"{number}.{ending}" for number in (1, 2)]
        for path in paths:
            write_scores(metrics, path)
        assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize("name", ["scores.xlsx", "scores"])
def test_an_unknown_ending_is_refused_before_anything_is_measured(
    tmp_path: Path, name: str
) -> None:
    with pytest.raises(InputError, match=r"\.csv, \.json, \.parquet"):
        check_ending(tmp_path / name)


def test_the_document_for_results_is_plain_and_says_why_a_number_is_missing(
    metrics: StudyMetrics,
) -> None:
    found = metrics_document(metrics)
    document = json.loads(json.dumps(found, allow_nan=False))
    assert document == found
    score = document["conditions"][0]
    assert (score["metric"], score["value"], score["spread_between_clips"]) == ("jerk", 1.5, None)
    assert score["settings"] == {"joints": "left_wrist, right_wrist"}
    assert document["skipped"] == [{"file": "b.npz", "what": "damaged", "remedy": "Copy it again"}]
    assert document["emotions"][0]["counts"] == [[2, 1]]


def test_parquet_has_types_and_tells_units_and_directions(
    metrics: StudyMetrics, tmp_path: Path
) -> None:
    write_scores(metrics, tmp_path / "scores.parquet")
    schema = parquet.read_schema(tmp_path / "scores.parquet")
    assert [str(schema.field(name).type) for name in ("value", "n")] == ["double", "int64"]
    assert "string" in str(schema.field("metric").type)
    assert json.loads(schema.metadata[b"units"]) == {"jerk": "m/s³"}
    assert json.loads(schema.metadata[b"better"]) == {"jerk": "unsaid"}
    assert schema.metadata[b"frame_rate"] == b"30"


def test_the_document_names_files_from_the_study_s_folder(
    metrics: StudyMetrics, tmp_path: Path
) -> None:
    skipped = SkippedFile(what="damaged", where=str(tmp_path / "motion" / "b.npz"), remedy="-")
    document = metrics_document(replace(metrics, skipped=(skipped,)), tmp_path)
    assert document["skipped"] == [{"file": "motion/b.npz", "what": "damaged", "remedy": "-"}]
