"""Bringing a folder of files into a study: speech, motion and finished videos, by their names.

Files in the folder itself are of the condition that is stated; those in a sub-folder are of the
condition that it is called after.
"""

from __future__ import annotations

import filecmp
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import replacing
from motion.formats.joint_positions import is_joint_table
from motion.segment import SEGMENTS_FILE, check_name
from studyapp.stimuli.media_probe import DURATION_TOLERANCE, flaw_of
from studyapp.stimuli.recordings import RecordingFacts, Take, import_clips, import_take
from studyapp.stimuli.stored_speech import import_speech
from studyapp.study.finished_videos import video_duration
from studyapp.study.folder import (
    COMPANION_ENDINGS,
    MOTION_ENDINGS,
    SPEECH_ENDINGS,
    VIDEO_ENDING,
    StudyFolder,
)
from studyapp.study.study_file import add_condition

TABLE: Final = ".csv"


@dataclass(frozen=True, kw_only=True)
class FolderItem:
    """Files that come into a study together, or not at all.

    Attributes
    ----------
    files : tuple of Path
        The one that it is about comes first.
    bring_in : callable
        Does it, and returns what was changed on the way.
    """

    files: tuple[Path, ...]
    bring_in: Callable[[], list[str]]


def folder_items(study: StudyFolder, folder: Path, facts: RecordingFacts) -> list[FolderItem]:
    """Return what is in `folder`, in an order in which it can be brought in: speech first.

    Raises
    ------
    InputError
        If there is nothing.
    """
    places = {folder: facts.condition}
    for each in sorted(folder.iterdir()):
        if each.is_dir() and not each.name.startswith("."):
            places[each] = each.name
    found = [_Place(study, place, condition, facts) for place, condition in places.items()]
    items = [
        item
        for listed in (_Place.speech, _Place.motion, _Place.videos, _Place.others)
        for place in found
        for item in listed(place)
    ]
    if not items:
        raise InputError(
            "there is no file to bring in", where=folder, remedy="Put files there first"
        )
    return items


class _Place:
    """One folder of files that belong to one condition."""

    def __init__(
        self, study: StudyFolder, folder: Path, condition: str | None, facts: RecordingFacts
    ) -> None:
        self._study, self._condition, self._facts = study, condition, facts
        self._left = {
            path.name: path
            for path in sorted(folder.iterdir())
            if path.is_file() and not path.name.startswith(".")
        }
        self._folder = folder

    def speech(self) -> Iterator[FolderItem]:
        """Yield what makes segments: a table with its recordings, takes, and speech alone."""
        table = self._left.get(SEGMENTS_FILE)
        if table is not None:
            told = {one.strip() for line in _lines(table) for one in line.split(",")}
            named = [path for path in self._of(SPEECH_ENDINGS) if path.name in told]
            files = self._taken([table, *named])
            yield FolderItem(
                files=files, bring_in=partial(import_speech, self._study, self._folder)
            )
        for speech in self._of(SPEECH_ENDINGS):
            motion = next((one for one in self._moving() if one.stem == speech.stem), None)
            files = self._taken([*([motion] if motion else []), speech, *self._beside(speech)])
            yield FolderItem(files=files, bring_in=partial(self._bring_take, motion, speech))

    def motion(self) -> Iterator[FolderItem]:
        """Yield motion of segments that the study has then."""
        for motion in self._moving():
            files = self._taken([motion, *self._beside(motion)])
            yield FolderItem(files=files, bring_in=partial(self._bring_clip, motion))

    def videos(self) -> Iterator[FolderItem]:
        """Yield finished videos."""
        for video in self._of((VIDEO_ENDING,)):
            bring_in = partial(self._bring_video, video)
            yield FolderItem(files=self._taken([video]), bring_in=bring_in)

    def others(self) -> Iterator[FolderItem]:
        """Yield what is nothing of these."""
        for path in list(self._left.values()):
            yield FolderItem(files=self._taken([path]), bring_in=partial(_refuse_unknown, path))

    def _of(self, endings: Sequence[str]) -> list[Path]:
        return [path for path in self._left.values() if path.suffix.lower() in endings]

    def _moving(self) -> list[Path]:
        tables = [path for path in self._of((TABLE,)) if is_joint_table(path)]
        return [*self._of(MOTION_ENDINGS), *tables]

    def _beside(self, path: Path) -> list[Path]:
        return [one for one in self._of(COMPANION_ENDINGS) if one.stem == path.stem]

    def _taken(self, files: Sequence[Path]) -> tuple[Path, ...]:
        for path in files:
            self._left.pop(path.name, None)
        return tuple(dict.fromkeys(files))

    def _bring_take(self, motion: Path | None, speech: Path) -> list[str]:
        facts = self._facts
        if facts.speaker is None or facts.emotion is None:
            raise InputError(
                "nothing says who speaks, and with which emotion",
                where=speech,
                remedy="Name the speaker and the emotion (--speaker, --emotion), or put a "
                f"{SEGMENTS_FILE} beside it that does",
            )
        told = vars(facts) | {"condition": motion and self._named_condition(motion)}
        take = Take(**told, motion=motion, speech=speech)
        return import_take(self._study, take)[1]

    def _bring_clip(self, motion: Path) -> list[str]:
        condition = self._named_condition(motion)
        return import_clips(self._study, [motion], condition, self._facts)

    def _bring_video(self, video: Path) -> list[str]:
        return import_video(self._study, video, self._named_condition(video))

    def _named_condition(self, path: Path) -> str:
        if self._condition is None:
            raise InputError(
                "nothing says of which condition this is",
                where=path,
                remedy="Name its condition (--condition), or put it into a folder of that name",
            )
        return self._condition


def import_video(study: StudyFolder, video: Path, condition: str) -> list[str]:
    """Store a finished video, named after its segment, in the study.

    Returns
    -------
    list of str
        What was changed on the way.

    Raises
    ------
    InputError
        If it cannot be played, is of another length than its segment, belongs to no segment or
        to a condition of motion, or the condition has another video for the segment.
    """
    definition = study.study()
    check_name(condition, "condition")
    is_known = condition in (*definition.conditions, definition.catch.condition)
    if is_known and not definition.is_finished(condition):
        raise InputError(
            f"condition {condition!r} has motion, no finished videos",
            where=study.definition,
            remedy="Bring the video in under another condition, or write videos = true for this "
            "one first",
        )
    # A segment, or a segment with another one's speech: no name holds an @.
    names = [check_name(name, "segment", video) for name in video.stem.split("@", 1)]
    _check_video(video, _seconds(study, names, video))
    stored = study.videos / condition / f"{video.stem}{VIDEO_ENDING}"
    if stored.is_file() and not filecmp.cmp(stored, video, shallow=False):
        raise InputError(
            f"condition {condition!r} has another video for segment {video.stem} already",
            where=stored,
            remedy="Bring this one in under another condition, or remove that file first",
        )
    if not is_known:
        add_condition(study.definition, condition, videos=True)
    with replacing(stored) as draft:
        shutil.copyfile(video, draft)
    return [] if is_known else [f"{study.definition.name}: condition {condition!r} added"]


def _seconds(study: StudyFolder, names: Sequence[str], video: Path) -> float:
    """Return how long a video should be: as its segment where the study has speech."""
    if not (study.speech / SEGMENTS_FILE).exists():
        return video_duration(video)
    segments: Mapping[str, float] = {one.name: one.duration for one in study.segments()}
    for name in names:
        if name not in segments:
            raise InputError(
                f"no segment is called {name!r}",
                where=video,
                remedy=f"Name the file after its segment ({', '.join(list(segments)[:3])}, …)",
            )
    return segments[names[0]]


def _check_video(video: Path, seconds: float) -> None:
    # Whether it needs sound, only the design tells: 'check' does.
    if flaw := flaw_of(video, seconds, sound=False):
        raise InputError(
            f"the video {flaw.what}",
            where=video,
            remedy="Bring it as H.264 and AAC in MP4; lengths may differ by "
            f"{DURATION_TOLERANCE} s",
        )


def _refuse_unknown(path: Path) -> list[str]:
    raise InputError(
        "this is neither speech, motion nor a finished video, nor named after one that lies here",
        where=path,
        remedy=f"Bring motion as {', '.join(MOTION_ENDINGS)} or a table of joints, speech as "
        f"{', '.join(SPEECH_ENDINGS)}, videos as {VIDEO_ENDING}",
    )


def _lines(table: Path) -> list[str]:
    return table.read_text("utf-8", errors="replace").splitlines()
