"""Scores as a table for programs: CSV, JSON or Parquet."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import Final

import pandas as pd
import pyarrow as pa
from pyarrow import parquet

from analysis.metrics.scores import ClipScore, ConditionScore, StudyMetrics
from motion.errors import InputError
from motion.files import replacing, write_text

_NUMBERS: Final = ("value", "spread_between_clips", "low", "high")
_COUNTS: Final = ("n", "clips_scored", "clips")

COLUMNS: Final = (
    *("condition", "segment", "metric", "value", "unit", "better", "spread_between_clips"),
    *("low", "high", "n", "clips_scored", "clips", "settings", "remark", "reason"),
)

_FIELDS: Final = {"metric": "name", "spread_between_clips": "spread", "clips_scored": "scored"}
"""Fields of scores whose column has another name."""

_TEXT: Final = pa.dictionary(pa.int32(), pa.string())
"""Texts repeat often, so Parquet stores each once."""

_TYPES: Final[Mapping[str, tuple[str, pa.DataType]]] = MappingProxyType(
    dict.fromkeys(COLUMNS, ("str", _TEXT))
    | dict.fromkeys(_NUMBERS, ("float64", pa.float64()))
    | dict.fromkeys(_COUNTS, ("Int64", pa.int64()))
)
"""Type of each column, in pandas and in Parquet."""


def score_table(metrics: StudyMetrics) -> pd.DataFrame:
    """Return every score as one row.

    Returns
    -------
    DataFrame
        Columns as in `COLUMNS`. First the scores of whole conditions, with an empty `segment` and
        the number of clips they average; then those of single clips, whose `n` is the number of
        items they average. ``low`` and ``high`` are the 95% interval, if there is one. A missing
        value is empty, with its reason.
    """
    scores: tuple[ConditionScore | ClipScore, ...] = (*metrics.conditions, *metrics.clips)
    rows = [{"segment": ""} | _row(score) for score in scores]
    types = {name: kind for name, (kind, _) in _TYPES.items()}
    return pd.DataFrame(rows, columns=list(COLUMNS)).astype(types)


def metrics_document(metrics: StudyMetrics, root: Path | None = None) -> dict[str, object]:
    """Return the scores of conditions as plain values, for ``results.json``.

    Parameters
    ----------
    metrics : StudyMetrics
        The scores.
    root : Path, optional
        Files are named relative to this folder, so that the document does not reveal its location.

    Returns
    -------
    dict
        ``frame_rate`` (frames per second, None without clips); ``conditions``, a list of
        ``condition``, ``metric``, ``value``, ``unit``, ``better``, ``spread_between_clips``,
        ``low``, ``high``, ``clips_scored``, ``clips``, ``settings`` (a mapping), ``remark`` and
        ``reason``; ``emotions``, a list of ``condition``, ``network``, ``spoken``, ``named`` and
        ``counts`` (a row for each spoken emotion); ``skipped``, a list of ``file``, ``what`` and
        ``remedy``; and ``remarks``. A number that does not exist is None, with its reason.
    """
    return {
        "frame_rate": _plain(metrics.frame_rate),
        "conditions": [
            {name: _plain(value) for name, value in _row(score).items()}
            | {"settings": dict(score.settings)}
            for score in metrics.conditions
        ],
        "emotions": [asdict(confusion) for confusion in metrics.confusions],
        "skipped": [
            {
                "file": file.where if root is None else file.where.removeprefix(f"{root}/"),
                "what": file.what,
                "remedy": file.remedy,
            }
            for file in metrics.skipped
        ],
        "remarks": list(metrics.remarks),
    }


def write_scores(metrics: StudyMetrics, path: Path) -> None:
    """Write all scores to `path` atomically, in the format of its ending.

    Raises
    ------
    InputError
        If the ending is none of .csv, .json and .parquet.
    """
    _writer(path)(metrics, path)


def check_ending(path: Path) -> None:
    """Raise `InputError` if `write_scores` has no format for `path`."""
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
    schema = pa.schema([(name, kind) for name, (_, kind) in _TYPES.items()])
    table = pa.Table.from_pandas(score_table(metrics), schema=schema, preserve_index=False)
    with replacing(path) as draft:
        parquet.write_table(table.replace_schema_metadata(_metadata(metrics)), draft)


def _metadata(metrics: StudyMetrics) -> dict[str, str]:
    """Return the metadata of a Parquet file: frame rate, and each metric's unit and direction."""
    units = {score.name: score.unit for score in metrics.conditions}
    better = {score.name: score.better for score in metrics.conditions}
    return {
        "frame_rate": f"{metrics.frame_rate:g}",
        "units": json.dumps(units, ensure_ascii=False),
        "better": json.dumps(better, ensure_ascii=False),
    }


def _write_json(metrics: StudyMetrics, path: Path) -> None:
    document = metrics_document(metrics)
    document["clips"] = [
        {
            name: _plain(value)
            for name, value in _row(score).items()
            if name == "value" or _plain(value) not in ("", None)
        }
        for score in metrics.clips
    ]
    write_text(path, json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


_WRITERS: Final[Mapping[str, Callable[[StudyMetrics, Path], None]]] = MappingProxyType(
    {".csv": _write_csv, ".json": _write_json, ".parquet": _write_parquet}
)


def _row(score: ConditionScore | ClipScore) -> dict[str, object]:
    """Return a score's values by column."""
    result = score.result if isinstance(score, ClipScore) else score
    low, high = result.interval or (None, None)
    settings = "; ".join(f"{key}: {value}" for key, value in result.settings.items())
    values = {**vars(result), **vars(score), "low": low, "high": high, "settings": settings}
    fields = {column: _FIELDS.get(column, column) for column in COLUMNS}
    return {column: values[field] for column, field in fields.items() if field in values}


def _plain(value: object) -> object:
    """Return a value that JSON can hold: None for NaN and infinity."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
