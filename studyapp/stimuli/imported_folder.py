"""Importing a folder of speech, motion and finished videos into a study, by their names.

Files in the folder itself belong to the given condition; files in a sub-folder belong to the
condition of its name.
"""

from __future__ import annotations

import filecmp
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from motion.endings import MOTION_ENDINGS, SPEECH_ENDINGS, VIDEO_ENDING
from motion.errors import InputError
from motion.files import replacing
from motion.segment import SEGMENTS_FILE, check_name
from studyapp.stimuli.media_probe import DURATION_TOLERANCE, flaw_of
from studyapp.stimuli.recordings import (
    RecordingFacts,
    Take,
    add_new_condition,
    import_clips,
    import_take,
)
from studyapp.stimuli.stored_speech import import_speech
from studyapp.study.folder import COMPANION_ENDINGS, StudyFolder, video_duration


@dataclass(frozen=True, kw_only=True)
class FolderItem:
    """Files that are imported together, or not at all.

    Attributes
    ----------
    files : tuple of Path
        The main file first.
    store : callable
        Imports them and returns notes.
    """

    files: tuple[Path, ...]
    store: Callable[[], list[str]]


def folder_items(study: StudyFolder, folder: Path, facts: RecordingFacts) -> list[FolderItem]:
    """Return the items of `folder` in the order of their import, speech first.

    Raises
    ------
    InputError
        If there are none.
    """
    conditions = {folder: facts.condition}
    for path in sorted(folder.iterdir()):
        if path.is_dir() and not path.name.startswith("."):
            conditions[path] = path.name
    sources = [_ConditionFolder(study, path, name, facts) for path, name in conditions.items()]
    kinds = (
        _ConditionFolder.speech,
        _ConditionFolder.motion,
        _ConditionFolder.videos,
        _ConditionFolder.others,
    )
    items = [item for kind in kinds for source in sources for item in kind(source)]
    if not items:
        raise InputError("there is no file to import", where=folder, remedy="Put files there first")
    return items


class _ConditionFolder:
    """A folder of files of one condition."""

    def __init__(
        self, study: StudyFolder, folder: Path, condition: str | None, facts: RecordingFacts
    ) -> None:
        self._study, self._condition, self._facts = study, condition, facts
        self._remaining = {
            path.name: path
            for path in sorted(folder.iterdir())
            if path.is_file() and not path.name.startswith(".")
        }
        self._folder = folder

    def speech(self) -> Iterator[FolderItem]:
        """Yield the items that add segments: a table with its recordings, takes, speech alone."""
        table = self._remaining.get(SEGMENTS_FILE)
        if table is not None:
            lines = table.read_text("utf-8", errors="replace").splitlines()
            cells = {cell.strip() for line in lines for cell in line.split(",")}
            named = [path for path in self._with_ending(SPEECH_ENDINGS) if path.name in cells]
            store = partial(import_speech, self._study, self._folder)
            yield FolderItem(files=self._take([table, *named]), store=store)
        for speech in self._with_ending(SPEECH_ENDINGS):
            motion = next(
                (file for file in self._with_ending(MOTION_ENDINGS) if file.stem == speech.stem),
                None,
            )
            files = [*([motion] if motion else []), speech, *self._companions(speech)]
            store = partial(self._store_take, motion, speech)
            yield FolderItem(files=self._take(files), store=store)

    def motion(self) -> Iterator[FolderItem]:
        """Yield motion of segments that exist by then."""
        for motion in self._with_ending(MOTION_ENDINGS):
            files = self._take([motion, *self._companions(motion)])
            yield FolderItem(files=files, store=partial(self._store_clip, motion))

    def videos(self) -> Iterator[FolderItem]:
        """Yield finished videos."""
        for video in self._with_ending((VIDEO_ENDING,)):
            yield FolderItem(files=self._take([video]), store=partial(self._store_video, video))

    def others(self) -> Iterator[FolderItem]:
        """Yield all other files, which are refused."""
        for path in list(self._remaining.values()):
            yield FolderItem(files=self._take([path]), store=partial(_refuse_unknown, path))

    def _with_ending(self, endings: Sequence[str]) -> list[Path]:
        return [path for path in self._remaining.values() if path.suffix.lower() in endings]

    def _companions(self, path: Path) -> list[Path]:
        return [file for file in self._with_ending(COMPANION_ENDINGS) if file.stem == path.stem]

    def _take(self, files: Sequence[Path]) -> tuple[Path, ...]:
        for path in files:
            self._remaining.pop(path.name, None)
        return tuple(dict.fromkeys(files))

    def _store_take(self, motion: Path | None, speech: Path) -> list[str]:
        facts = self._facts
        if facts.speaker is None or facts.emotion is None:
            raise InputError(
                "the speaker and the emotion are unknown",
                where=speech,
                remedy="Name the speaker and the emotion (--speaker, --emotion), or put a "
                f"{SEGMENTS_FILE} beside it that does",
            )
        condition = motion and self._require_condition(motion)
        take = Take(**vars(facts) | {"condition": condition}, motion=motion, speech=speech)
        return import_take(self._study, take)[1]

    def _store_clip(self, motion: Path) -> list[str]:
        condition = self._require_condition(motion)
        return import_clips(self._study, [motion], condition, self._facts)

    def _store_video(self, video: Path) -> list[str]:
        return import_video(self._study, video, self._require_condition(video))

    def _require_condition(self, path: Path) -> str:
        if self._condition is None:
            raise InputError(
                "the condition is unknown",
                where=path,
                remedy="Name its condition (--condition), or put it into a folder of that name",
            )
        return self._condition


def import_video(study: StudyFolder, video: Path, condition: str) -> list[str]:
    """Store a finished video, named after its segment, in the study.

    Returns
    -------
    list of str
        Notes for the researcher.

    Raises
    ------
    InputError
        If the video cannot be played, has no segment or another length, or its condition has
        motion or another video for the segment.
    """
    definition = study.study()
    check_name(condition, "condition")
    is_known = condition in (*definition.conditions, definition.catch.condition)
    if is_known and not definition.is_finished(condition):
        raise InputError(
            f"condition {condition!r} has motion instead of finished videos",
            where=study.definition,
            remedy="Import the video under another condition, or set videos = true for this one "
            "first",
        )
    # A segment, or a segment with the speech of another one; names contain no @.
    names = [check_name(name, "segment", video) for name in video.stem.split("@", 1)]
    # Only the design knows whether it needs sound, which 'check' tests.
    if flaw := flaw_of(video, _expected_seconds(study, names, video), sound=False):
        raise InputError(
            f"the video {flaw.what}",
            where=video,
            remedy="Provide it as H.264 and AAC in MP4; lengths may differ by "
            f"{DURATION_TOLERANCE} s",
        )
    stored = study.videos / condition / f"{video.stem}{VIDEO_ENDING}"
    if stored.is_file() and not filecmp.cmp(stored, video, shallow=False):
        raise InputError(
            f"condition {condition!r} already has another video for segment {video.stem}",
            where=stored,
            remedy="Import this one under another condition, or remove that file first",
        )
    notes = add_new_condition(study, definition, condition, videos=True)
    with replacing(stored) as draft:
        shutil.copyfile(video, draft)
    return notes


def _expected_seconds(study: StudyFolder, names: Sequence[str], video: Path) -> float:
    """Return the length of a video's segment, or its own without speech."""
    if not (study.speech / SEGMENTS_FILE).exists():
        return video_duration(video)
    segments: Mapping[str, float] = {item.name: item.duration for item in study.segments()}
    for name in names:
        if name not in segments:
            raise InputError(
                f"there is no segment {name!r}",
                where=video,
                remedy=f"Name the file after its segment ({', '.join(list(segments)[:3])}, …)",
            )
    return segments[names[0]]


def _refuse_unknown(path: Path) -> list[str]:
    raise InputError(
        "this is neither speech, motion nor a finished video, nor a companion of one",
        where=path,
        remedy=f"Provide motion as {', '.join(MOTION_ENDINGS)}, speech as "
        f"{', '.join(SPEECH_ENDINGS)}, videos as {VIDEO_ENDING}",
    )
