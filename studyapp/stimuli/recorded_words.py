"""What is said in a take, and which of its gestures mean something, from the files beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from motion.audio import Audio
from motion.errors import InputError
from motion.formats.semantic_txt import SemanticSpan, cut_semantic_scores, read_semantic_scores
from motion.formats.transcript import preferred_transcript, read_transcript
from motion.segment import Segment

_PLAIN = ".lab"
_SEMANTIC = ".txt"


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
        return list(segments), [
            f"{beside.name} lies beside {motion.name} and is left out: {error.what}"
        ]
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
        return {}, [f"{beside.name} lies beside {motion.name} and is left out: {error.what}"]
    scores = {one.name: cut_semantic_scores(spans, one.start, one.end) for one in segments}
    return scores, [f"{motion.name}: the semantic scores are those of {beside.name}"]
