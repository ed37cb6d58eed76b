"""A study's speech and its table of segments, to which imports only add.

A take may have companion files of the name of its motion: a transcript, and semantic scores.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio, read_audio, write_wav
from motion.errors import InputError, found_at
from motion.formats.beat_tracks import SemanticSpan, cut_semantic_scores, read_semantic_scores
from motion.formats.transcript import preferred_transcript, read_transcript
from motion.segment import (
    SEGMENTS_FILE,
    Segment,
    check_name,
    read_segments,
    write_segments,
)
from studyapp.study.folder import StudyFolder

ROUNDING: Final = 1e-3
"""Share of full scale by which 16-bit WAV may change a recording."""


def import_speech(folder: StudyFolder, speech: Path) -> list[str]:
    """Store the recordings of a folder `speech` and the segments in its ``segments.csv``.

    Returns
    -------
    list of str
        Changes made while reading.

    Raises
    ------
    InputError
        If the table or a recording cannot be used, or a segment of the same name exists with other
        times or other speech. Nothing is written then.
    """
    new = read_segments(speech)
    names = {item.wav: check_name(Path(item.wav).stem, "recording", speech) for item in new}
    segments = [replace(segment, wav=f"{names[segment.wav]}.wav") for segment in new]
    existing = existing_segments(folder)
    require_same_times(existing, segments, folder)
    notes: list[str] = []
    for wav, name in names.items():
        audio = read_audio(speech / wav, sample_rate=None)
        for segment in new:
            if segment.wav == wav:
                with found_at(f"{speech / SEGMENTS_FILE}, segment {segment.name}"):
                    audio.cut(segment.start, segment.end)
        require_same_speech(folder.speech / f"{name}.wav", audio)
        notes += audio.notes
    # Read again, since all recordings together may not fit into memory.
    for wav, name in names.items():
        audio = read_audio(speech / wav, sample_rate=None)
        write_wav(folder.speech / f"{name}.wav", replace(audio, notes=()))
    store_segments(folder, existing, segments)
    return notes


def existing_segments(folder: StudyFolder) -> tuple[Segment, ...]:
    """Return the study's segments; empty without speech."""
    return read_segments(folder.speech) if (folder.speech / SEGMENTS_FILE).exists() else ()


def store_segments(
    folder: StudyFolder, existing: Sequence[Segment], new: Sequence[Segment]
) -> list[Segment]:
    """Add segments to the study's table and return them with their stored transcripts."""
    transcripts = {segment.name: segment.transcript for segment in existing}
    stored = [
        replace(segment, transcript=segment.transcript or transcripts.get(segment.name, ""))
        for segment in new
    ]
    merged = {segment.name: segment for segment in (*existing, *stored)}
    write_segments(folder.speech, tuple(merged.values()))
    return stored


def require_same_speech(stored: Path, audio: Audio) -> None:
    """Raise `InputError` if `stored` exists and is another recording than `audio`."""
    if not stored.exists():
        return
    recording = read_audio(stored, sample_rate=None)
    if recording.sample_rate != audio.sample_rate or not (
        recording.samples.shape == audio.samples.shape
        and np.allclose(recording.samples, audio.samples, atol=ROUNDING)
    ):
        raise InputError(
            "another recording is stored under this name",
            where=stored,
            remedy="Rename the new recording; its segments are named after it",
        )


def require_same_times(
    existing: Sequence[Segment], new: Sequence[Segment], folder: StudyFolder
) -> None:
    """Raise `InputError` if a new segment has other times than the existing one of its name."""
    by_name = {segment.name: segment for segment in existing}
    for segment in new:
        old = by_name.get(segment.name)
        if old is not None and (old.start, old.end) != (segment.start, segment.end):
            raise InputError(
                f"segment {segment.name} exists with other times "
                f"({old.start:g}–{old.end:g} s, now {segment.start:g}–{segment.end:g} s)",
                where=folder.speech / "segments.csv",
                remedy="Use another file name, or remove the old segments first",
            )


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
        if len(segments) == 1 and companion.suffix == ".lab":
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
    companion = motion.with_suffix(".txt")
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
