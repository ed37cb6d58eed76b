import json
import math
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

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
    path, again = tmp_path / f"scores.{ending}", tmp_path / f"again.{ending}"
    for written in (path, again):
        write_scores(metrics, written)
    read = pd.read_csv(path) if ending == "csv" else pd.read_parquet(path)
    assert tuple(read.columns) == COLUMNS
    assert read["segment"].fillna("").tolist() == ["", "a", "a"]
    assert read["clips"].isna().tolist() == [False, True, True]
    assert read["n"].isna().tolist() == [True, False, False]
    assert read["value"].tolist()[:2] == [1.5, 1.5]
    assert math.isnan(read["value"][2])
    assert read["reason"][2] == "no beat"
    assert read["unit"][0] == "m/s³"
    assert path.read_bytes() == again.read_bytes()


def test_the_document_holds_conditions_confusions_and_files_without_nan(
    metrics: StudyMetrics,
) -> None:
    document = json.loads(json.dumps(metrics_document(metrics, Path("/study")), allow_nan=False))
    score = document["conditions"][0]
    assert (score["metric"], score["value"], score["spread_between_clips"]) == ("jerk", 1.5, None)
    assert score["settings"] == {"joints": "left_wrist, right_wrist"}
    assert document["frame_rate"] == 30
    assert document["emotions"][0]["counts"] == [[2, 1]]
    skipped = {"file": "motion/b.npz", "what": "damaged", "remedy": "Copy it again"}
    assert document["skipped"] == [skipped]


@pytest.mark.parametrize("name", ["scores.xlsx", "scores"])
def test_unknown_endings_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"\.csv or \.parquet"):
        check_ending(Path(name))


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
