"""What is to be said of how loud a study's videos are."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from motion.audio import read_audio
from motion.errors import InputError
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from renderer.loudness import at_common_loudness
from studyapp.definition.folder import StudyFolder


def loudness_notes(folder: StudyFolder, segments: Iterable[Segment]) -> tuple[str, ...]:
    """Return a sentence for each segment whose speech cannot be made as loud as the others'.

    Nothing is said of speech that cannot be read: making its videos fails, and says why.
    """
    of_recording: defaultdict[str, list[Segment]] = defaultdict(list)
    for segment in segments:
        of_recording[segment.wav].append(segment)
    notes: list[str] = []
    for wav, spoken in of_recording.items():
        try:
            recording = read_audio(folder.speech / wav, sample_rate=SOUND_RATE)
            excerpts = [recording.cut(segment.start, segment.end) for segment in spoken]
        except InputError:
            continue
        for segment, speech in zip(spoken, excerpts, strict=True):
            new = at_common_loudness(speech).notes[len(speech.notes) :]
            notes.extend(f"the speech of segment {segment.name}: {note}" for note in new)
    return tuple(notes)
