"""BEAT's (Liu et al. 2022) tracks other than body motion.

Facial motion: ARKit blendshape weights as JSON, at 60 fps. Semantic scores of gestures: a
tab-separated text without a header: name, start, end, duration (seconds), score, keywords.
"""

import csv
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, FiniteFloat, ValidationError

from motion.arrays import Floats, Floats32
from motion.clip import ARKIT_COUNT, ARKIT_NAMES
from motion.errors import InputError, found_at
from motion.files import write_text

_OVERSHOOT: Final = 0.05
"""Largest distance of a weight from [0, 1] that is clipped; trackers sometimes exceed the range."""

_LONGEST_FRAME: Final = 1.0
"""Largest plausible mean time between frames, in seconds; longer times are in another unit."""


class _Frame(BaseModel):
    weights: list[FiniteFloat]
    time: FiniteFloat


class _FaceFile(BaseModel):
    names: Annotated[list[str], Field(min_length=1)]
    frames: Annotated[list[_Frame], Field(min_length=2)]


def face_beside(motion: Path) -> Path:
    """Return the path at which BEAT, and its users, store the face of a `motion` file."""
    return motion.with_suffix(".json")


def read_arkit_json(path: Path, frame_rate: float) -> Floats32:
    """Read the facial weights of a take at the frame rate of its clip.

    Parameters
    ----------
    path : Path
        A JSON object with ``names`` and ``frames``, each of ``time`` (seconds) and ``weights``.
    frame_rate : float
        Frames per second of the result.

    Returns
    -------
    ndarray, shape (T, 52), float32
        Weights in [0, 1], in the order of `motion.clip.ARKIT_NAMES`, from time 0 on,
        interpolated linearly; zero for actions that the file lacks. The last frame of the file
        lasts as long as its frames do on average.

    Raises
    ------
    InputError
        If the file is not such JSON, names an unknown action, its times do not increase or are not
        in seconds, or its weights are outside [0, 1].
    """
    face = _parse(Path(path))
    with found_at(path):
        columns = _columns(face.names)
        times = np.array([frame.time for frame in face.frames])
        steps = np.diff(times)
        if steps.min() <= 0 or steps.mean() > _LONGEST_FRAME:
            raise InputError(
                f"the times of {len(times)} frames from {times[0]:.4g} to {times[-1]:.4g} do not "
                "increase, or are not seconds",
                remedy="Sort the frames by time, remove duplicates, and give seconds",
            )
        if {len(frame.weights) for frame in face.frames} != {len(columns)}:
            raise InputError(
                f"a frame does not have {len(columns)} weights, one for each name",
                remedy="Export the face again",
            )
        weights = np.array([frame.weights for frame in face.frames])
        if weights.min() < -_OVERSHOOT or weights.max() > 1 + _OVERSHOOT:
            raise InputError(
                f"weights lie in [{weights.min():.3g}, {weights.max():.3g}]",
                remedy="Scale the blendshape weights to [0, 1]",
            )
    duration = times[-1] + steps.mean()
    frame_times = np.arange(max(1, round(duration * frame_rate))) / frame_rate
    result = np.zeros((len(frame_times), ARKIT_COUNT), np.float32)
    for column, values in zip(columns, np.clip(weights, 0, 1).T, strict=True):
        result[:, column] = np.interp(frame_times, times, values)
    return result


def write_arkit_json(path: Path, weights: NDArray[np.floating], frame_rate: float) -> None:
    """Write facial weights in BEAT's format, in one step.

    Parameters
    ----------
    path : Path
        The file; missing folders are made.
    weights : ndarray, shape (T, N), N <= 52
        Weights in [0, 1] of the first N actions of `motion.clip.ARKIT_NAMES`, T > 0; written with
        four decimals.
    frame_rate : float
        Frames per second; frame k lies at ``k / frame_rate`` seconds.
    """
    content = {
        "names": list(ARKIT_NAMES[: weights.shape[1]]),
        "frames": [
            {"weights": row, "time": round(number / frame_rate, 6)}
            for number, row in enumerate(np.round(weights, 4).tolist())
        ],
    }
    write_text(Path(path), json.dumps(content, separators=(",", ":")) + "\n")


def _parse(path: Path) -> _FaceFile:
    try:
        return _FaceFile.model_validate_json(path.read_bytes())
    except OSError as error:
        raise InputError(
            "the file of facial weights cannot be read", where=path, remedy="Check the path"
        ) from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise InputError(
            f"the file is not JSON of facial weights ({place or 'whole file'}: {first['msg']})",
            where=path,
            remedy="Give 'names' and 'frames' with 'time' and 'weights', as BEAT has them",
        ) from error


def _columns(names: list[str]) -> list[int]:
    """Return the column of a clip's weights for each name of the file."""
    index_of_name = {name.lower(): index for index, name in enumerate(ARKIT_NAMES)}
    unknown = [name for name in names if name.lower() not in index_of_name]
    if unknown or len({name.lower() for name in names}) != len(names):
        fault = f"unknown facial actions {', '.join(unknown)}" if unknown else "a name occurs twice"
        raise InputError(fault, remedy="Use the 52 names of Apple's ARKit, each once")
    return [index_of_name[name.lower()] for name in names]


@dataclass(frozen=True, kw_only=True)
class SemanticSpan:
    """One annotated gesture.

    Attributes
    ----------
    start, end : float
        Seconds, ``0 <= start <= end``.
    score : float
        Semantic relevance, at least 0.
    """

    start: float
    end: float
    score: float


def read_semantic_scores(path: Path) -> tuple[SemanticSpan, ...]:
    """Read the annotated gestures of one recording.

    Parameters
    ----------
    path : Path
        A text file in BEAT's format; columns after the score are ignored.

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
    """Write annotated gestures in BEAT's format, each with the name ``beat``."""
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
    """Return the spans between `start` and `end`, in seconds from `start`."""
    overlapping = (span for span in spans if span.start < end and span.end > start)
    return tuple(
        SemanticSpan(
            start=max(span.start, start) - start, end=min(span.end, end) - start, score=span.score
        )
        for span in overlapping
    )


def _span(row: list[str], where: str) -> SemanticSpan:
    try:
        span = SemanticSpan(start=float(row[1]), end=float(row[2]), score=float(row[4]))
        if not (0 <= span.start <= span.end < math.inf and 0 <= span.score < math.inf):
            raise ValueError
    except (ValueError, IndexError) as error:
        raise InputError(
            "the row is not an annotation of a gesture",
            where=where,
            remedy="Give name, start, end, duration and score, separated by tabs; 0 <= start <= "
            "end",
        ) from error
    return span


def semantic_weights(spans: tuple[SemanticSpan, ...], frames: int, frame_rate: float) -> Floats:
    """Return the score of each frame, shape (frames,); 0 without an annotated gesture.

    Frame k is at ``k / frame_rate`` seconds; if gestures overlap, the greater score counts.
    """
    time = np.arange(frames) / frame_rate
    weights = np.zeros(frames)
    for span in spans:
        in_span = (time >= span.start) & (time < span.end)
        weights[in_span] = np.maximum(weights[in_span], span.score)
    return weights
