"""Scores as a table for programs: CSV, JSON or Parquet."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

import pandas as pd

from analysis.metrics.conditions import ConditionScore, StudyMetrics
from analysis.metrics.segment_scores import ClipScore
from motion.errors import InputError
from motion.files import replacing, write_text

COLUMNS: Final = (
    "condition",
    "segment",
    "metric",
    "value",
    "unit",
    "better",
    "spread_between_clips",
    "n",
    "clips_scored",
    "clips",
    "settings",
    "remark",
    "reason",
)


def score_table(metrics: StudyMetrics) -> pd.DataFrame:
    """Return every score as one row.

    Returns
    -------
    DataFrame
        Columns as in `COLUMNS`. First the scores of whole conditions, whose `segment` is empty and
        which say how many clips they are a mean over; then those of single clips, whose `n` says
        how many things they are a mean over. A missing value is empty, with its reason.
    """
    rows = [_of_condition(score) for score in metrics.conditions]
    rows += [_of_clip(score) for score in metrics.clips]
    table = pd.DataFrame.from_records(rows, columns=list(COLUMNS))
    return table.astype(dict.fromkeys(("n", "clips_scored", "clips"), "Int64"))


def write_scores(metrics: StudyMetrics, path: Path) -> None:
    """Write all scores to `path`, in one step, in the format that its ending names.

    Raises
    ------
    InputError
        If the ending is none of .csv, .json and .parquet.
    """
    _writer(path)(metrics, path)


def check_ending(path: Path) -> None:
    """Raise `InputError` where `write_scores` knows no format for `path`."""
    _writer(path)


def _writer(path: Path) -> Callable[[StudyMetrics, Path], None]:
    writer = _WRITERS.get(path.suffix.lower())
    if writer is None:
        raise InputError(
            f"scores are not written as {path.suffix or 'a file without an ending'!r}",
            where=path,
            remedy=f"Name a file that ends in {', '.join(_WRITERS)}",
        )
    return writer


def _write_csv(metrics: StudyMetrics, path: Path) -> None:
    with replacing(path) as draft:
        score_table(metrics).to_csv(draft, index=False, lineterminator="\n")


def _write_parquet(metrics: StudyMetrics, path: Path) -> None:
    with replacing(path) as draft:
        score_table(metrics).to_parquet(draft, engine="pyarrow", index=False)


def _write_json(metrics: StudyMetrics, path: Path) -> None:
    found = {
        "frame_rate": _number(metrics.frame_rate),
        "conditions": [_plain(_of_condition(score)) for score in metrics.conditions],
        "clips": [_plain(_of_clip(score)) for score in metrics.clips],
        "skipped": [
            {"file": file.where, "what": file.what, "remedy": file.remedy}
            for file in metrics.skipped
        ],
    }
    write_text(path, json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


_WRITERS: Final[Mapping[str, Callable[[StudyMetrics, Path], None]]] = MappingProxyType(
    {".csv": _write_csv, ".json": _write_json, ".parquet": _write_parquet}
)


def _of_condition(score: ConditionScore) -> dict[str, object]:
    return {
        "condition": score.condition,
        "segment": "",
        "metric": score.name,
        "value": score.value,
        "unit": score.unit,
        "better": score.better,
        "spread_between_clips": score.spread,
        "n": None,
        "clips_scored": score.scored,
        "clips": score.clips,
        "settings": _words(score.settings),
        "remark": "",
        "reason": score.reason,
    }


def _of_clip(score: ClipScore) -> dict[str, object]:
    result = score.result
    return {
        "condition": score.condition,
        "segment": score.segment,
        "metric": result.name,
        "value": result.value,
        "unit": result.unit,
        "better": result.better,
        "spread_between_clips": math.nan,
        "n": result.n,
        "clips_scored": None,
        "clips": None,
        "settings": _words(result.settings),
        "remark": result.remark,
        "reason": result.reason,
    }


def _plain(row: Mapping[str, object]) -> dict[str, object]:
    """Return a row as JSON holds it: no NaN, nothing that does not apply."""
    values = {
        name: _number(value) if isinstance(value, float) else value for name, value in row.items()
    }
    return {name: value for name, value in values.items() if value not in ("", None)} | {
        "value": values["value"]
    }


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _words(settings: Mapping[str, str]) -> str:
    return "; ".join(f"{key}: {value}" for key, value in settings.items())
