"""Companion files of recorded motion, of the same name: transcript and semantic scores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from motion.audio import Audio
from motion.errors import InputError
from motion.formats.beat_tracks import (
    SemanticSpan,
    cut_semantic_scores,
    read_semantic_scores,
)
from motion.formats.transcript import preferred_transcript, read_transcript
from motion.segment import Segment

_PLAIN = ".lab"
_SEMANTIC = ".txt"


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
