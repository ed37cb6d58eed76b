"""Scores as a table for programs: CSV, JSON or Parquet."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

import pandas as pd
import pyarrow as pa
from pyarrow import parquet

from analysis.measurement.conditions import ConditionScore, StudyMetrics
from analysis.measurement.segment_scores import ClipScore
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
    "low",
    "high",
    "n",
    "clips_scored",
    "clips",
    "settings",
    "remark",
    "reason",
)


Row = tuple[object, ...]
"""Values in the order of `COLUMNS`."""

_NUMBERS: Final = ("value", "spread_between_clips", "low", "high")
_COUNTS: Final = ("n", "clips_scored", "clips")

_TYPES: Final[Mapping[str, str]] = MappingProxyType(
    {
        name: "float64" if name in _NUMBERS else "Int64" if name in _COUNTS else "str"
        for name in COLUMNS
    }
)

_SCHEMA: Final = pa.schema(
    [
        (
            name,
            pa.float64()
            if name in _NUMBERS
            else pa.int64()
            if name in _COUNTS
            else pa.dictionary(pa.int32(), pa.string()),
        )
        for name in COLUMNS
    ]
)
"""Texts repeat a great deal, so that Parquet holds each once."""


def score_table(metrics: StudyMetrics) -> pd.DataFrame:
    """Return every score as one row.

    Returns
    -------
    DataFrame
        Columns as in `COLUMNS`. First the scores of whole conditions, whose `segment` is empty and
        which say how many clips they are a mean over; then those of single clips, whose `n` says
        how many things they are a mean over. ``low`` and ``high`` are the 95 % interval of a score
        that has one. A missing value is empty, with its reason.
    """
    rows = [_of_condition(score) for score in metrics.conditions]
    words = _Words()
    rows += [_of_clip(score, words) for score in metrics.clips]
    columns = {name: [row[place] for row in rows] for place, name in enumerate(COLUMNS)}
    table = pd.DataFrame({name: pd.Series(columns[name], dtype=_TYPES[name]) for name in COLUMNS})
    return table


def metrics_document(metrics: StudyMetrics, root: Path | None = None) -> dict[str, object]:
    """Return the scores of conditions as plain values, for ``results.json``.

    Parameters
    ----------
    metrics : StudyMetrics
        The scores.
    root : Path, optional
        Files are named from this folder, so that the document does not tell where it lies.

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
        "frame_rate": _number(metrics.frame_rate),
        "conditions": [
            {
                "condition": score.condition,
                "metric": score.name,
                "value": _number(score.value),
                "unit": score.unit,
                "better": score.better,
                "spread_between_clips": _number(score.spread),
                "low": None if score.interval is None else _number(score.interval[0]),
                "high": None if score.interval is None else _number(score.interval[1]),
                "clips_scored": score.scored,
                "clips": score.clips,
                "settings": dict(score.settings),
                "remark": score.remark,
                "reason": score.reason,
            }
            for score in metrics.conditions
        ],
        "emotions": [
            {
                "condition": found.condition,
                "network": found.network,
                "spoken": list(found.spoken),
                "named": list(found.named),
                "counts": [list(row) for row in found.counts],
            }
            for found in metrics.confusions
        ],
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
    table = pa.Table.from_pandas(score_table(metrics), schema=_SCHEMA, preserve_index=False)
    with replacing(path) as draft:
        parquet.write_table(table.replace_schema_metadata(_metadata(metrics)), draft)


def _metadata(metrics: StudyMetrics) -> dict[str, str]:
    """Return what a Parquet file says of its metrics: units, directions and settings by name."""
    units: dict[str, str] = {}
    better: dict[str, str] = {}
    for score in metrics.conditions:
        units.setdefault(score.name, score.unit)
        better.setdefault(score.name, score.better)
    return {
        "frame_rate": f"{metrics.frame_rate:g}",
        "units": json.dumps(units, ensure_ascii=False),
        "better": json.dumps(better, ensure_ascii=False),
    }


def _write_json(metrics: StudyMetrics, path: Path) -> None:
    document = metrics_document(metrics)
    words = _Words()
    document["clips"] = [
        _plain(dict(zip(COLUMNS, _of_clip(score, words), strict=True))) for score in metrics.clips
    ]
    write_text(path, json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


_WRITERS: Final[Mapping[str, Callable[[StudyMetrics, Path], None]]] = MappingProxyType(
    {".csv": _write_csv, ".json": _write_json, ".parquet": _write_parquet}
)


def _of_condition(score: ConditionScore) -> Row:
    low, high = score.interval or (None, None)
    return (
        score.condition,
        "",
        score.name,
        score.value,
        score.unit,
        score.better,
        score.spread,
        low,
        high,
        None,
        score.scored,
        score.clips,
        _in_words(score.settings),
        score.remark,
        score.reason,
    )


def _of_clip(score: ClipScore, words: _Words) -> Row:
    result = score.result
    low, high = result.interval or (None, None)
    return (
        score.condition,
        score.segment,
        result.name,
        result.value,
        result.unit,
        result.better,
        None,
        low,
        high,
        result.n,
        None,
        None,
        words.of(result.settings),
        result.remark,
        result.reason,
    )


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


def _in_words(settings: Mapping[str, str]) -> str:
    return "; ".join(f"{key}: {value}" for key, value in settings.items())


class _Words:
    """Settings in words, made once for all scores that share the mapping: there are many."""

    def __init__(self) -> None:
        self._made: dict[int, tuple[Mapping[str, str], str]] = {}

    def of(self, settings: Mapping[str, str]) -> str:
        """Return what `settings` are, in words."""
        held = self._made.get(id(settings))
        if held is None:
            held = self._made[id(settings)] = (settings, _in_words(settings))
        return held[1]
