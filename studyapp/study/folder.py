"""A study folder: its paths and segments, its lock for one command at a time, its disk."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Final

from motion.audio import WHOLE_FORMATS
from motion.endings import MOTION_ENDINGS, SPEECH_ENDINGS, VIDEO_ENDING
from motion.errors import InputError
from motion.segment import EMOTIONS, Segment, check_name, read_segments
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.study import Study

COMPANION_ENDINGS: Final = (".csv", ".json", ".textgrid", ".lab", ".txt")
"""Tables of segments, and files that accompany a motion or its speech."""

IMPORTABLE_ENDINGS: Final = tuple(
    dict.fromkeys((*MOTION_ENDINGS, *SPEECH_ENDINGS, VIDEO_ENDING, *COMPANION_ENDINGS))
)
"""Files that can be imported into a study."""


MIN_SIMILARITY: Final = 0.8
"""Similarity (see `difflib`) from which one name counts as a misspelling of another."""


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

    elsewhere = _PathInFolder("database.txt")
    """The address of the database of participants that was named in place of `responses`."""

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

    shared_answers = _PathInFolder("shared_answers.json.gz")
    """Answers that another lab has shared, in place of a database."""

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

    def locked(self) -> AbstractContextManager[None]:
        """Keep other imports and rehearsals of the study out during the block."""
        busy = InputError(
            "this study is already being rehearsed, or something is being imported into it",
            where=self.root,
            remedy="Wait until that command ends, or stop it",
        )
        return lock_folder(self.root, busy=busy)

    def study(self) -> Study:
        """Read and validate the study file."""
        return read_study(self.definition)

    def has_segments(self, study: Study) -> bool:
        """Return whether there is speech, or finished videos that take its place."""
        if (self.speech / "segments.csv").exists():
            return True
        is_finished = all(condition.videos for condition in study.conditions.values())
        return is_finished and any(self.videos.glob(f"*/*{VIDEO_ENDING}"))

    def segments(self) -> tuple[Segment, ...]:
        """Read the segments; `InputError` if there are none yet."""
        return read_segments(self.speech)

    def segments_of(self, study: Study) -> tuple[Segment, ...]:
        """Read the segments of `study`.

        A study with nothing but finished videos needs no speech files: the videos' names are its
        segments. A study that allows gaps has only segments with a finished video of every
        condition that brings them.
        """
        finished = [name for name, condition in study.conditions.items() if condition.videos]
        if len(finished) == len(study.conditions) and not (self.speech / "segments.csv").exists():
            return _finished_segments(self.videos, finished, allow_gaps=study.allow_gaps)
        segments = self.segments()
        if not study.allow_gaps:
            return segments
        return tuple(
            segment
            for segment in segments
            if all((self.videos / name / f"{segment.name}.mp4").is_file() for name in finished)
        )


def _finished_segments(
    videos: Path, conditions: Sequence[str], *, allow_gaps: bool
) -> tuple[Segment, ...]:
    """Return the segments named by the finished videos of `conditions`.

    For studies without speech files: speaker and emotion are unknown.

    Parameters
    ----------
    allow_gaps : bool
        Whether to leave out segments that a condition lacks. Otherwise they stay in the study,
        and `motionjury check` names the missing videos.

    Raises
    ------
    InputError
        If there is no video, no segment is left, a file name is not a valid segment name, or a
        segment's length cannot be read.
    """
    videos_of = {
        condition: {
            path.stem: path
            for path in sorted((videos / condition).glob("*.mp4"))
            if "@" not in path.stem
        }
        for condition in conditions
    }
    owners: dict[str, list[str]] = {}
    for condition, files in videos_of.items():
        for name, path in files.items():
            owners.setdefault(check_name(name, "segment", path), []).append(condition)
    if allow_gaps:
        names = {name for name, owning in owners.items() if len(owning) == len(conditions)}
    else:
        names = set(owners) - _misspelt_names(owners, conditions[0])
    if not names:
        paths = ", ".join(f"{condition}/<segment>.mp4" for condition in conditions)
        raise InputError(
            "no segment has a finished video of every condition"
            if owners
            else "there are no finished videos yet",
            where=videos,
            remedy="Bring them in with 'motionjury import', or save them as "
            f"{paths}, with the same names in each folder",
        )
    return tuple(
        Segment(
            name=name,
            wav="",
            start=0.0,
            end=_duration([videos_of[condition][name] for condition in owners[name]]),
            speaker="",
            emotion=EMOTIONS[0],
        )
        for name in sorted(names)
    )


def _duration(videos: Sequence[Path]) -> float:
    """Return the duration of the first video that can be opened."""
    *others, last = videos
    for video in others:
        with suppress(InputError):
            return video_duration(video)
    return video_duration(last)


def _misspelt_names(owners: Mapping[str, Sequence[str]], first: str) -> set[str]:
    """Return the names that misspell another one: they are similar, and no condition has both.

    The name that more conditions have is right; on a tie, that of the condition `first`.
    """
    misspelt: set[str] = set()
    correct: list[str] = []
    for name in sorted(
        owners, key=lambda name: (-len(owners[name]), first not in owners[name], name)
    ):
        candidates = [
            other.casefold() for other in correct if not set(owners[other]) & set(owners[name])
        ]
        if get_close_matches(name.casefold(), candidates, n=1, cutoff=MIN_SIMILARITY):
            misspelt.add(name)
        else:
            correct.append(name)
    return misspelt


def similar_file(file: Path, needed: Collection[Path]) -> Path | None:
    """Return the file that may be the missing `file` under a misspelt name.

    Parameters
    ----------
    needed : collection of Path
        Files that the study needs under their own names.
    """
    unneeded = {
        path.name.casefold(): path
        for path in sorted(file.parent.glob("*"))
        if path.is_file() and path not in needed
    }
    matches = get_close_matches(file.name.casefold(), unneeded, n=1, cutoff=MIN_SIMILARITY)
    return unneeded[matches[0]] if matches else None


def video_duration(video: Path) -> float:
    """Return the duration of a video in seconds; `InputError` if it cannot be opened."""
    import av

    try:
        with av.open(str(video), options=dict(WHOLE_FORMATS)) as container:
            return (container.duration or 0) / av.time_base
    except (av.FFmpegError, OSError):
        raise InputError(
            "this is not a playable video",
            where=video,
            remedy="Provide an MP4 file with H.264 video and AAC audio",
        ) from None


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
