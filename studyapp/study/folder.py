"""The paths in a study folder, its lock for one command at a time, and the room on its disk."""

from __future__ import annotations

import fcntl
import os
import shutil
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
"""Tables of joints or segments, and files that accompany a motion or its speech."""

IMPORTABLE_ENDINGS: Final = (*MOTION_ENDINGS, *SPEECH_ENDINGS, VIDEO_ENDING, *COMPANION_ENDINGS)
"""Files that can be imported into a study."""


class _PathInFolder:
    """A path below the study folder."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, folder: StudyFolder, owner: type[StudyFolder]) -> Path:
        return folder.root / self._name


@dataclass(frozen=True)
class StudyFolder:
    """The paths of one study; creating one does not touch the disk."""

    root: Path

    definition = _PathInFolder("study.toml")
    """The study file."""

    speech = _PathInFolder("speech")
    """Folder of ``segments.csv`` and the recordings that it names."""

    videos = _PathInFolder("videos")
    """Folder of the rendered media."""

    stimuli = _PathInFolder("stimuli.json")
    """What each rendered file shows."""

    responses = _PathInFolder("responses.db")
    """SQLite database of real participants."""

    rehearsal = _PathInFolder("rehearsal.db")
    """SQLite database of simulated participants; never mixed with the real one."""

    inbox = _PathInFolder("inbox")
    """Folder of uploads at a desk that are not in the study yet."""

    tries = _PathInFolder("tries.db")
    """SQLite database of tryouts; never mixed with the real one."""

    rehearsal_truth = _PathInFolder("rehearsal.json")
    """The simulated participants, and the true values that follow from them."""

    rehearsal_findings = _PathInFolder("rehearsal")
    """Folder of what a rehearsal recorded and found."""

    acknowledged = _PathInFolder("rehearsal/acknowledged.jsonl")
    """The answers that the server acknowledged to simulated participants, one a line."""

    pseudonym_key = _PathInFolder("pseudonyms.key")
    """Key of the participants' pseudonyms; it is never exported."""

    shared_answers = _PathInFolder("shared_answers")
    """Folder of answers that another lab has shared, in place of a database."""

    report = _PathInFolder("report")
    """Folder of the report."""

    figures = _PathInFolder("figures")
    """Folder of figures for a paper; they name conditions and are never served."""

    joint_positions = _PathInFolder(".joint-positions")
    """Cache of the metrics; it may be removed at any time."""

    jobs = _PathInFolder("jobs")
    """Folder of the desk's jobs, a sub-folder for each kind."""

    evaluators = _PathInFolder("evaluators")
    """Folder of the metrics' feature networks, ``*.safetensors``."""

    metrics = _PathInFolder("metrics.parquet")
    """Automatic metrics, by condition and by clip."""

    def clip(self, condition: str, segment: str) -> Path:
        """Return the motion clip of `condition` for `segment`."""
        return self.root / "motion" / condition / f"{segment}.npz"

    def recording(self, segment: Segment) -> Path:
        """Return the file with the speech of `segment`.

        A segment that finished videos alone make known is heard in the first of them.
        """
        if segment.wav:
            return self.speech / segment.wav
        return min(self.videos.glob(f"*/{segment.name}.mp4"), default=self.videos)

    def semantics(self, segment: str) -> Path:
        """Return BEAT's annotations of semantic gestures in a recording."""
        return self.speech / f"{segment}.txt"

    def study(self) -> Study:
        """Read and validate the study file."""
        return read_study(self.definition)

    def segments(self) -> Sequence[Segment]:
        """Read the segments; `InputError` if there are none yet."""
        if not (self.speech / "segments.csv").exists():
            raise InputError(
                "the study has no speech yet",
                where=self.speech / "segments.csv",
                remedy="Bring recordings in with 'motionjury import'",
            )
        return read_segments(self.speech)

    def segments_of(self, study: Study) -> Sequence[Segment]:
        """Read the segments of `study`.

        A study with nothing but finished videos needs no speech files: the videos' names are its
        segments. A study that allows gaps has only segments with a finished video of every
        condition that brings them.
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
    """Hold a lock on `folder` during the block; raise `busy` if another process holds it.

    It is the operating system's lock on the folder itself: it leaves no file behind, and ends with
    the process that holds it, however that ends.
    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise busy from None
        yield
    finally:
        os.close(descriptor)


_UNITS: Final = ((10**9, "GB"), (10**6, "MB"))


def format_size(size: float) -> str:
    """Return a number of bytes in kB, MB or GB."""
    unit, name = next(((unit, name) for unit, name in _UNITS if size >= unit), (1000, "kB"))
    return f"{size / unit:.1f} {name}"


def require_space(folder: Path, needed: float, *, work: str, remedy: str) -> None:
    """Raise `InputError` if `work` may need more bytes than the disk of `folder` has."""
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise InputError(
            f"{work} may need {format_size(needed)}, but only {format_size(free)} are free",
            where=folder,
            remedy=remedy,
        )
