"""What is to be said of how loud a study's videos are."""

from __future__ import annotations

from collections.abc import Iterable

from motion.audio import read_audio
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from renderer.loudness import at_common_loudness
from studyapp.definition.folder import StudyFolder


def loudness_notes(folder: StudyFolder, segments: Iterable[Segment]) -> tuple[str, ...]:
    """Return a sentence for each segment whose speech cannot be made as loud as the others'."""
    notes: list[str] = []
    for segment in segments:
        recording = read_audio(folder.speech / segment.wav, sample_rate=SOUND_RATE)
        speech = recording.cut(segment.start, segment.end)
        new = at_common_loudness(speech).notes[len(speech.notes) :]
        notes.extend(f"the speech of segment {segment.name}: {note}" for note in new)
    return tuple(notes)
