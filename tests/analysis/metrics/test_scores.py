from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from pyarrow import parquet

from analysis.metrics.emotion_accuracy import emotion_confusion
from analysis.metrics.score_tables import COLUMNS, check_ending, metrics_document, write_scores
from analysis.metrics.scores import ClipScore, Metric, MetricResult, StudyMetrics, whole_condition
from motion.errors import InputError


@pytest.fixture
def metrics() -> StudyMetrics:
    """Return scores of one condition, of which one is missing."""
    settings = {"joints": "left_wrist, right_wrist"}
    jerk = Metric("jerk", "m/s³", "near the reference").score(1.5, 40, settings)
    missing = Metric("beat alignment").missing("no beat")
    skipped = InputError("damaged", where="/study/motion/b.npz", remedy="Copy it again")
    confusion = emotion_confusion(
        ["anger"] * 3, ["anger", "anger", "fear"], ("anger", "fear"), condition="o", network="n"
    )
    return StudyMetrics(
        frame_rate=30.0,
        clips=tuple(
            ClipScore(condition="ours", segment="a", result=result) for result in (jerk, missing)
        ),
        conditions=(whole_condition("ours", jerk, 1),),
        skipped=(skipped,),
        confusions=(confusion,),
    )


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_tables_survive_a_round_trip_with_conditions_before_clips(
    metrics: StudyMetrics, tmp_path: Path, ending: str
) -> None:
    path = tmp_path / f"scores.{ending}"
    write_scores(metrics, path)
    read = pd.read_csv(path) if ending == "csv" else pd.read_parquet(path)
    assert tuple(read.columns) == COLUMNS
    assert read["segment"].fillna("").tolist() == ["", "a", "a"]
    assert read["clips"].isna().tolist() == [False, True, True]
    assert read["n"].isna().tolist() == [True, False, False]
    assert read["value"].tolist()[:2] == [1.5, 1.5]
    assert math.isnan(read["value"][2])
    assert read["reason"][2] == "no beat"
    assert read["unit"][0] == "m/s³"


def test_parquet_files_have_types_units_and_directions(
    metrics: StudyMetrics, tmp_path: Path
) -> None:
    write_scores(metrics, tmp_path / "scores.parquet")
    schema = parquet.read_schema(tmp_path / "scores.parquet")
    assert [str(schema.field(name).type) for name in ("value", "n")] == ["double", "int64"]
    assert "string" in str(schema.field("metric").type)
    assert json.loads(schema.metadata[b"units"]) == {"jerk": "m/s³"}
    assert json.loads(schema.metadata[b"better"]) == {"jerk": "near the reference"}
    assert schema.metadata[b"frame_rate"] == b"30"


def test_json_holds_the_document_and_the_clips_without_nan(
    metrics: StudyMetrics, tmp_path: Path
) -> None:
    path = tmp_path / "scores.json"
    write_scores(metrics, path)
    written = json.loads(path.read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert written.pop("clips")[1] == {
        "condition": "ours",
        "segment": "a",
        "metric": "beat alignment",
        "value": None,
        "better": "unsaid",
        "n": 0,
        "reason": "no beat",
    }
    assert written == json.loads(json.dumps(metrics_document(metrics)))
    score = written["conditions"][0]
    assert (score["metric"], score["value"], score["spread_between_clips"]) == ("jerk", 1.5, None)
    assert score["settings"] == {"joints": "left_wrist, right_wrist"}
    assert written["frame_rate"] == 30
    assert written["emotions"][0]["counts"] == [[2, 1]]
    skipped = {"file": "motion/b.npz", "what": "damaged", "remedy": "Copy it again"}
    assert metrics_document(metrics, Path("/study"))["skipped"] == [skipped]


def test_tables_are_reproducible_and_unknown_extensions_are_refused(
    metrics: StudyMetrics, tmp_path: Path
) -> None:
    for ending in ("csv", "json", "parquet"):
        paths = [tmp_path / f"{number}.{ending}" for number in (1, 2)]
        for path in paths:
            write_scores(metrics, path)
        assert paths[0].read_bytes() == paths[1].read_bytes()
    for name in ("scores.xlsx", "scores"):
        with pytest.raises(InputError, match=r"\.csv, \.json, \.parquet"):
            check_ending(tmp_path / name)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"value": math.nan}, "reason"),
        ({"value": 0.5, "reason": "no beats"}, "reason"),
        ({"value": 1.0, "interval": (2.0, 1.0)}, "interval"),
    ],
)
def test_only_missing_scores_have_reasons_and_intervals_are_ordered(
    fields: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        MetricResult(name="m", unit="", n=1, **fields)
