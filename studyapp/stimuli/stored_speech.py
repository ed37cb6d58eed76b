"""A study's recordings and its table of segments: adding to them without changing what is there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio, read_audio, write_wav
from motion.errors import InputError, found_at
from motion.segment import (
    SEGMENTS_FILE,
    Segment,
    check_name,
    read_segments,
    write_segments,
)
from studyapp.study.folder import StudyFolder

ROUNDING: Final = 1e-3
"""Share of full scale by which storing a recording as 16-bit WAV may change it."""


def import_speech(folder: StudyFolder, speech: Path) -> list[str]:
    """Store all recordings of a folder `speech`, and the segments that its ``segments.csv`` tells.

    Returns
    -------
    list of str
        What was changed on the way.

    Raises
    ------
    InputError
        If the table or a recording cannot be used, or a segment of the same name but another
        place or other speech exists. Nothing is written then.
    """
    given = read_segments(speech)
    files = {one.wav: check_name(Path(one.wav).stem, "recording", speech) for one in given}
    segments = [replace(one, wav=f"{files[one.wav]}.wav") for one in given]
    known = known_segments(folder)
    check_no_clash(known, segments, folder)
    notes: list[str] = []
    for wav, name in files.items():
        audio = read_audio(speech / wav, sample_rate=None)
        for one in given:
            if one.wav == wav:
                with found_at(f"{speech / SEGMENTS_FILE}, segment {one.name}"):
                    audio.cut(one.start, one.end)
        check_same_speech(folder.speech / f"{name}.wav", audio)
        notes += audio.notes
    # Read anew: all of them together may be more than memory holds.
    for wav, name in files.items():
        audio = read_audio(speech / wav, sample_rate=None)
        write_wav(folder.speech / f"{name}.wav", replace(audio, notes=()))
    store_segments(folder, known, segments)
    return notes


def known_segments(folder: StudyFolder) -> tuple[Segment, ...]:
    """Return the study's segments; none where it has no speech yet."""
    if not (folder.speech / "segments.csv").exists():
        return ()
    return read_segments(folder.speech)


def store_segments(
    folder: StudyFolder, known: Sequence[Segment], new: Sequence[Segment]
) -> list[Segment]:
    """Add segments to the study's table; return them with the words that were known before."""
    told = {segment.name: segment.transcript for segment in known}
    stored = [replace(one, transcript=one.transcript or told.get(one.name, "")) for one in new]
    merged = {segment.name: segment for segment in (*known, *stored)}
    write_segments(folder.speech, tuple(merged.values()))
    return stored


def check_same_speech(stored: Path, audio: Audio) -> None:
    """Raise if another recording is stored under the name that `audio` would get."""
    if not stored.exists():
        return
    known = read_audio(stored, sample_rate=None)
    if known.sample_rate != audio.sample_rate or not (
        known.samples.shape == audio.samples.shape
        and np.allclose(known.samples, audio.samples, atol=ROUNDING)
    ):
        raise InputError(
            "another recording is stored under this name",
            where=stored,
            remedy="Rename the new recording: its segments are named after it",
        )


def check_no_clash(known: Sequence[Segment], new: Sequence[Segment], folder: StudyFolder) -> None:
    """Raise if importing `new` would change what an existing segment is."""
    existing = {segment.name: segment for segment in known}
    for segment in new:
        old = existing.get(segment.name)
        if old is not None and (old.start, old.end) != (segment.start, segment.end):
            raise InputError(
                f"segment {segment.name} exists with other times "
                f"({old.start:g}–{old.end:g} s, now {segment.start:g}–{segment.end:g} s)",
                where=folder.speech / "segments.csv",
                remedy="Use another file name, or remove the old segments first",
            )
