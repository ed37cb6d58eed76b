"""Where everything lies in a study's folder, and the lock of one command at a time on it."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.segment import Segment, read_segments
from studyapp.study.finished_videos import finished_segments
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.study import Study

MOTION_ENDINGS: Final = (".bvh", ".npz", ".npy")
SPEECH_ENDINGS: Final = (
    ".wav", ".flac", ".mp3", ".m4a", ".ogg", ".oga", ".opus", ".aif", ".aiff",
)  # fmt: skip
VIDEO_ENDING: Final = ".mp4"
COMPANION_ENDINGS: Final = (".csv", ".json", ".textgrid", ".lab", ".txt")
"""Of tables of joints or of segments, and of what may lie beside a motion or its speech."""

IMPORTABLE_ENDINGS: Final = (*MOTION_ENDINGS, *SPEECH_ENDINGS, VIDEO_ENDING, *COMPANION_ENDINGS)
"""Endings of files that can be brought into a study."""


class _PathInFolder:
    """A path within a study's folder."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, folder: StudyFolder, owner: type[StudyFolder]) -> Path:
        return folder.root / self._name


@dataclass(frozen=True)
class StudyFolder:
    """The paths of one study; making one touches no disk."""

    root: Path

    definition = _PathInFolder("study.toml")
    """The study file."""

    speech = _PathInFolder("speech")
    """Folder of ``segments.csv`` and the recordings it names."""

    videos = _PathInFolder("videos")
    """Folder of the rendered media."""

    stimuli = _PathInFolder("stimuli.json")
    """What each rendered file is."""

    responses = _PathInFolder("responses.db")
    """SQLite database of real participants."""

    rehearsal = _PathInFolder("rehearsal.db")
    """SQLite database of simulated participants; never mixed with the real one."""

    inbox = _PathInFolder("inbox")
    """Folder of what was uploaded at a desk, until it is in the study."""

    tries = _PathInFolder("tries.db")
    """SQLite database of test participations; never mixed with the real one."""

    rehearsal_truth = _PathInFolder("rehearsal.json")
    """Whom a rehearsal simulated, and the true values that follow."""

    rehearsal_findings = _PathInFolder("rehearsal")
    """Folder of what a rehearsal's participants were told, and of what came of it."""

    acknowledged = _PathInFolder("rehearsal/acknowledged.jsonl")
    """What the simulated participants were told is stored, line by line."""

    pseudonym_key = _PathInFolder("pseudonyms.key")
    """Key of the participants' pseudonyms; it is never exported."""

    shared_answers = _PathInFolder("shared_answers")
    """Folder of answers that another lab has passed on, in place of a database."""

    report = _PathInFolder("report")
    """Folder of the report."""

    figures = _PathInFolder("figures")
    """Folder of figures for a paper; they name conditions and are never served."""

    joint_positions = _PathInFolder(".joint-positions")
    """Folder in which metrics keep what they computed; it may be removed at any time."""

    jobs = _PathInFolder("jobs")
    """Folder of what the desk has run, a sub-folder for each kind of job."""

    evaluators = _PathInFolder("evaluators")
    """Folder of feature networks with which metrics measure, ``*.safetensors``."""

    metrics = _PathInFolder("metrics.parquet")
    """Automatic metrics, by condition and by clip."""

    def clip(self, condition: str, segment: str) -> Path:
        """Return the motion clip of `condition` for `segment`."""
        return self.root / "motion" / condition / f"{segment}.npz"

    def semantics(self, segment: str) -> Path:
        """Return the semantic scores of a recording's gestures, as BEAT annotates them."""
        return self.speech / f"{segment}.txt"

    def study(self) -> Study:
        """Read and validate the study file."""
        return read_study(self.definition)

    def segments(self) -> Sequence[Segment]:
        """Read the segments; a study without any is an error that says what to do."""
        if not (self.speech / "segments.csv").exists():
            raise InputError(
                "the study has no speech yet",
                where=self.speech / "segments.csv",
                remedy="Bring recordings in with 'motionjury import'",
            )
        return read_segments(self.speech)

    def segments_of(self, study: Study) -> Sequence[Segment]:
        """Read the segments of `study`, as `segments` does.

        A study of finished videos alone needs no speech files: without them, its segments are
        those that the videos are named after. A study that allows gaps has only segments that
        every condition with finished videos has one of.
        """
        finished = [name for name, condition in study.conditions.items() if condition.videos]
        if len(finished) == len(study.conditions) and not (self.speech / "segments.csv").exists():
            return finished_segments(self.videos, finished, allow_gaps=study.allow_gaps)
        segments = self.segments()
        if not study.allow_gaps:
            return segments
        return [
            segment
            for segment in segments
            if all((self.videos / name / f"{segment.name}.mp4").is_file() for name in finished)
        ]


@contextmanager
def lock_folder(folder: Path, *, busy: InputError) -> Iterator[None]:
    """Hold a lock on `folder` during the block.

    The lock is the system's and lies on the folder itself: it leaves no file behind, and ends
    with the process that holds it, however that ends.

    Raises
    ------
    InputError
        `busy`, if another process holds it.
    """
    held = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise busy from None
        yield
    finally:
        os.close(held)
