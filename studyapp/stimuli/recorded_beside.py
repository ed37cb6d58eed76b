"""What lies beside recorded motion under its name: a face, words, semantic scores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.beat_tracks import (
    SemanticSpan,
    cut_semantic_scores,
    read_arkit_json,
    read_semantic_scores,
)
from motion.formats.transcript import preferred_transcript, read_transcript
from motion.segment import Segment

_PLAIN = ".lab"
_SEMANTIC = ".txt"


def read_recorded(path: Path, **options: Any) -> tuple[MotionClip, list[str]]:
    """Return recorded motion with the face beside it, and what was noted of both."""
    clip = read_motion(path, **options)
    note = clip.provenance.get("notes", "")
    clip, face_notes = _with_face_beside(clip, path)
    return clip, [*([f"{path.name}: {note}"] if note else []), *face_notes]


def _with_face_beside(clip: MotionClip, path: Path) -> tuple[MotionClip, list[str]]:
    """Return `clip` with the face that a recording has beside it, and what there is to say of it.

    BEAT and those who generate in its format keep a take's face in a JSON file of the same name.

    Parameters
    ----------
    clip : MotionClip
        A motion; one that has a face is returned as it is.
    path : Path
        The file that it was read from.

    Returns
    -------
    MotionClip
        Frames behind the face's last one hold that.
    list of str
        For the researcher to read; a file that is no face is left out and named.
    """
    beside = path.with_suffix(".json")
    if clip.arkit is not None or clip.expressions is not None or not beside.is_file():
        return clip, []
    try:
        face = read_arkit_json(beside, clip.frame_rate)
    except InputError as error:
        return clip, _left_out(beside, path, error)
    shown = face[np.minimum(np.arange(len(clip)), len(face) - 1)]
    return replace(clip, arkit=shown), [f"{path.name}: the face is that of {beside.name}"]


def with_words_beside(
    segments: Sequence[Segment], motion: Path, audio: Audio
) -> tuple[list[Segment], list[str]]:
    """Return the segments of a take with what is said in each, and what there is to say of it.

    Parameters
    ----------
    segments : sequence of Segment
        In seconds of the take.
    motion : Path
        The take's motion; its transcript has the same name and is a TextGrid, a table of words or
        plain text, which is spread over the speech where the take is cut.
    audio : Audio
        The take's speech.
    """
    files = {
        path.suffix.lower(): path
        for path in sorted(motion.parent.iterdir())
        if path.stem == motion.stem
    }
    beside = preferred_transcript(files.get)
    if beside is None:
        return list(segments), []
    try:
        words = read_transcript(beside, audio)
        if len(segments) == 1 and beside.suffix == _PLAIN:
            said = [" ".join(beside.read_text(encoding="utf-8-sig").split())]
        else:
            said = [
                " ".join(w.text for w in words if one.start <= (w.start + w.end) / 2 < one.end)
                for one in segments
            ]
    except InputError as error:
        return list(segments), _left_out(beside, motion, error)
    told = [replace(one, transcript=text) for one, text in zip(segments, said, strict=True)]
    return told, [f"{motion.name}: the words are those of {beside.name}"]


def semantics_beside(
    segments: Sequence[Segment], motion: Path
) -> tuple[dict[str, tuple[SemanticSpan, ...]], list[str]]:
    """Return which gestures of each segment mean something, and what there is to say of it.

    Parameters
    ----------
    segments : sequence of Segment
        In seconds of the take.
    motion : Path
        The take's motion; BEAT's semantic scores lie beside it in a text of the same name.
    """
    beside = motion.with_suffix(_SEMANTIC)
    if not beside.is_file():
        return {}, []
    try:
        spans = read_semantic_scores(beside)
    except InputError as error:
        return {}, _left_out(beside, motion, error)
    scores = {one.name: cut_semantic_scores(spans, one.start, one.end) for one in segments}
    return scores, [f"{motion.name}: the semantic scores are those of {beside.name}"]


def _left_out(beside: Path, motion: Path, error: InputError) -> list[str]:
    return [f"{beside.name} lies beside {motion.name} and is left out: {error.what}"]
