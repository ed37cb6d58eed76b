"""Scores as a table for programs: CSV or Parquet."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Final

import pandas as pd

from analysis.metrics.scores import ClipScore, ConditionScore, StudyMetrics
from motion.errors import InputError
from motion.files import replacing, write_frame

COLUMNS: Final = (
    *("condition", "segment", "metric", "value", "unit", "better", "spread_between_clips"),
    *("low", "high", "n", "clips_scored", "clips", "settings", "remark", "reason"),
)

_FIELDS: Final = {"metric": "name", "spread_between_clips": "spread", "clips_scored": "scored"}
"""Fields of scores whose column has another name."""

_TYPES: Final = (
    dict.fromkeys(COLUMNS, "str")
    | dict.fromkeys(("value", "spread_between_clips", "low", "high"), "float64")
    | dict.fromkeys(("n", "clips_scored", "clips"), "Int64")
)


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
    return pd.DataFrame(rows, columns=list(COLUMNS)).astype(_TYPES)


def metrics_document(metrics: StudyMetrics, root: Path) -> dict[str, object]:
    """Return the scores of conditions as plain values, for ``results.json``.

    Parameters
    ----------
    metrics : StudyMetrics
        The scores.
    root : Path
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
                "file": file.where.removeprefix(f"{root}/"),
                "what": file.what,
                "remedy": file.remedy,
            }
            for file in metrics.skipped
        ],
        "remarks": list(metrics.remarks),
    }


ENDINGS: Final = (".csv", ".parquet")


def check_ending(path: Path) -> None:
    """Raise `InputError` if `write_scores` has no format for `path`."""
    if path.suffix.lower() not in ENDINGS:
        raise InputError(
            f"scores are not written as {path.suffix or 'a file without an ending'!r}",
            where=path,
            remedy=f"Name a file that ends in {' or '.join(ENDINGS)}",
        )


def write_scores(metrics: StudyMetrics, path: Path) -> None:
    """Write all scores to `path` in one step, in the format of its ending.

    Raises
    ------
    InputError
        If the ending is none of `ENDINGS`.
    """
    check_ending(path)
    table = score_table(metrics)
    if path.suffix.lower() == ".csv":
        write_frame(path, table)
        return
    with replacing(path) as draft:
        table.to_parquet(draft, index=False)


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
