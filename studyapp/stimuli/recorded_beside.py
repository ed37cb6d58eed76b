"""Companion files of recorded motion, of the same name: face, transcript, semantic scores."""

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
from motion.segment import CUT_TOLERANCE, Segment

_PLAIN = ".lab"
_SEMANTIC = ".txt"


def read_recorded(path: Path, **options: Any) -> tuple[MotionClip, list[str]]:
    """Return recorded motion with the face in its companion file, and notes on both."""
    clip = read_motion(path, **options)
    note = clip.provenance.get("notes", "")
    clip, face_notes = _add_face(clip, path)
    return clip, [*([f"{path.name}: {note}"] if note else []), *face_notes]


def _add_face(clip: MotionClip, path: Path) -> tuple[MotionClip, list[str]]:
    """Return `clip` with the face of its JSON file, and notes.

    BEAT, and generators that use its format, store a take's face in a JSON file of the same name.
    A clip that has a face is returned unchanged; after the last frame, the face stays still.
    """
    companion = path.with_suffix(".json")
    if clip.arkit is not None or clip.expressions is not None or not companion.is_file():
        return clip, []
    try:
        face = read_arkit_json(companion, clip.frame_rate)
    except InputError as error:
        return clip, _left_out(companion, path, error)
    frames = face[np.minimum(np.arange(len(clip)), len(face) - 1)]
    note = f"{path.name}: the face is from {companion.name}"
    missing = (len(clip) - len(face)) / clip.frame_rate
    if missing > CUT_TOLERANCE:
        note += f" and stays still for the last {missing:.1f} s, which that file lacks"
    return replace(clip, arkit=frames), [note]


def add_transcripts(
    segments: Sequence[Segment], motion: Path, audio: Audio
) -> tuple[list[Segment], list[str]]:
    """Return the segments of a take with their transcripts, and notes.

    Parameters
    ----------
    segments : sequence of Segment
        With times relative to the take.
    motion : Path
        The take's motion. Its transcript of the same name is a TextGrid, a table of words, or
        plain text, whose words are spread over the speech if the take is cut.
    audio : Audio
        The take's speech.
    """
    files = {
        path.suffix.lower(): path
        for path in sorted(motion.parent.iterdir())
        if path.stem == motion.stem
    }
    companion = preferred_transcript(files.get)
    if companion is None:
        return list(segments), []
    try:
        words = read_transcript(companion, audio)
        if len(segments) == 1 and companion.suffix == _PLAIN:
            texts = [" ".join(companion.read_text(encoding="utf-8-sig").split())]
        else:
            texts = [
                " ".join(w.text for w in words if item.start <= (w.start + w.end) / 2 < item.end)
                for item in segments
            ]
    except InputError as error:
        return list(segments), _left_out(companion, motion, error)
    transcribed = [
        replace(segment, transcript=text) for segment, text in zip(segments, texts, strict=True)
    ]
    return transcribed, [f"{motion.name}: the transcript is from {companion.name}"]


def cut_semantics(
    segments: Sequence[Segment], motion: Path
) -> tuple[dict[str, tuple[SemanticSpan, ...]], list[str]]:
    """Return the semantic scores of each segment of a take, and notes.

    Parameters
    ----------
    segments : sequence of Segment
        With times relative to the take.
    motion : Path
        The take's motion; BEAT's semantic scores are in a text file of the same name.
    """
    companion = motion.with_suffix(_SEMANTIC)
    if not companion.is_file():
        return {}, []
    try:
        spans = read_semantic_scores(companion)
    except InputError as error:
        return {}, _left_out(companion, motion, error)
    scores = {item.name: cut_semantic_scores(spans, item.start, item.end) for item in segments}
    return scores, [f"{motion.name}: the semantic scores are from {companion.name}"]


def _left_out(companion: Path, motion: Path, error: InputError) -> list[str]:
    return [f"{companion.name}, beside {motion.name}, is left out: {error.what}"]
