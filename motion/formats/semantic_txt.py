"""Semantic scores of gestures, as BEAT annotates them (Liu et al. 2022).

A tab-separated text without a header: name, start, end, duration (seconds), score, keywords.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.files import write_text

_FEWEST_COLUMNS: Final = 5


@dataclass(frozen=True, kw_only=True)
class SemanticSpan:
    """One annotated gesture.

    Attributes
    ----------
    start, end : float
        Seconds, ``0 <= start <= end``.
    score : float
        How much it means, at least 0.
    """

    start: float
    end: float
    score: float


def read_semantic_scores(path: Path) -> tuple[SemanticSpan, ...]:
    """Read the annotated gestures of one recording.

    Parameters
    ----------
    path : Path
        A text file as BEAT has it; columns behind the score are not looked at.

    Raises
    ------
    InputError
        If the file cannot be read or a row is not an annotation; the message names file and line.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            "the semantic scores cannot be read",
            where=path,
            remedy="Give a text file in UTF-8 as BEAT has it",
        ) from error
    rows = csv.reader(text.splitlines(), delimiter="\t", quoting=csv.QUOTE_NONE)
    return tuple(
        _span(row, f"{path}, line {line}")
        for line, row in enumerate(rows, start=1)
        if any(cell.strip() for cell in row)
    )


def write_semantic_scores(path: Path, spans: Iterable[SemanticSpan]) -> None:
    """Write annotated gestures as BEAT has them, under the name of a beat."""
    write_text(
        path,
        "".join(
            f"beat\t{span.start:.3f}\t{span.end:.3f}\t{span.end - span.start:.3f}"
            f"\t{span.score:.3f}\t\n"
            for span in spans
        ),
    )


def cut_semantic_scores(
    spans: Iterable[SemanticSpan], start: float, end: float
) -> tuple[SemanticSpan, ...]:
    """Return what lies between `start` and `end`, in seconds from `start`."""
    inside = (span for span in spans if span.start < end and span.end > start)
    return tuple(
        SemanticSpan(
            start=max(span.start, start) - start, end=min(span.end, end) - start, score=span.score
        )
        for span in inside
    )


def _span(row: list[str], where: str) -> SemanticSpan:
    try:
        if len(row) < _FEWEST_COLUMNS:
            raise ValueError
        span = SemanticSpan(start=float(row[1]), end=float(row[2]), score=float(row[4]))
    except ValueError as error:
        raise _no_annotation(where) from error
    if not (0 <= span.start <= span.end < math.inf and 0 <= span.score < math.inf):
        raise _no_annotation(where)
    return span


def _no_annotation(where: str) -> InputError:
    return InputError(
        "the row is not an annotation of a gesture",
        where=where,
        remedy="Give name, start, end, duration and score, separated by tabs; 0 <= start <= end",
    )


def semantic_weights(
    spans: tuple[SemanticSpan, ...], frames: int, frame_rate: float
) -> NDArray[np.float64]:
    """Return the score of each frame, shape (frames,); 0 where no gesture is annotated.

    Frame k lies at ``k / frame_rate`` seconds; where gestures overlap, the greater score counts.
    """
    time = np.arange(frames) / frame_rate
    weights = np.zeros(frames)
    for span in spans:
        inside = (time >= span.start) & (time < span.end)
        weights[inside] = np.maximum(weights[inside], span.score)
    return weights
