"""The study folder whose conditions are compared on the corpus' test takes."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import tomlkit

from benchmarks.learned_motion.recordings import FRAME_RATE, write_recordings
from motion.audio import Audio, read_audio
from motion.files import write_text
from motion.segment import Segment, write_segments
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import GROUND_TRUTH
from training.data.take import Take

MISMATCHED: Final = "mismatched"
RULE_BASED: Final = "rule_based"
UNTRAINED: Final = "untrained"


def segment_of(take: Take, audio: Audio) -> Segment:
    """Return a take's whole speech as a segment."""
    return Segment(
        name=take.name,
        wav=take.speech.name,
        start=0.0,
        end=audio.duration,
        speaker=take.speaker,
        emotion=take.emotion,
    )


def write_study(
    root: Path,
    takes: Sequence[Take],
    generators: Mapping[str, Mapping[str, str | Path]],
    *,
    seed: int,
) -> StudyFolder:
    """Write the study; existing motion stays.

    Parameters
    ----------
    root : Path
        The study's folder.
    takes : sequence of Take
        Takes whose speech is used.
    generators : mapping of condition to mapping
        Name and files of each learned generator, as in a study file.
    seed : int
        Seed of all generators.
    """
    folder = StudyFolder(root)
    folder.speech.mkdir(parents=True, exist_ok=True)
    segments = []
    for take in takes:
        wav = folder.speech / take.speech.name
        if not wav.exists():
            wav.hardlink_to(take.speech)
        segments.append(segment_of(take, read_audio(wav)))
    write_segments(folder.speech, segments)
    write_recordings(takes, lambda take: folder.clip(GROUND_TRUTH, take.name))
    write_text(folder.definition, _definition(root, generators, seed))
    return folder


def _definition(root: Path, generators: Mapping[str, Mapping[str, str | Path]], seed: int) -> str:
    conditions: dict[str, dict[str, str]] = {
        GROUND_TRUTH: {},
        MISMATCHED: {"generator": MISMATCHED, "source": GROUND_TRUTH},
        RULE_BASED: {"generator": RULE_BASED},
    }
    for condition, settings in generators.items():
        conditions[condition] = {
            key: os.path.relpath(value, root) if isinstance(value, Path) else value
            for key, value in settings.items()
        }
    return tomlkit.dumps(
        {
            "name": "learned-motion",
            "title": "Learned motion",
            "seed": seed,
            "reference": RULE_BASED,
            "participants_per_comparison": 1,
            "trials": 1,
            "practice": 0,
            "video": {"frame_rate": FRAME_RATE},
            "conditions": conditions,
            "catch": {"trials": 0},
            "page": {"minutes": 1, "consent": "Nobody takes part: motion is measured."},
            "questions": [{"name": "fit", "title": "Fit", "text": "Which fits the speech?"}],
        }
    )
