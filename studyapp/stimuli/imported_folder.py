"""Importing a folder of speech, motion and finished videos into a study, by their names.

Files in the folder itself belong to the given condition; files in a sub-folder belong to the
condition of its name.
"""

import filecmp
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Final

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
    folders = [path for path in sorted(folder.iterdir()) if path.is_dir() and path.name[0] != "."]
    conditions = {folder: facts.condition} | {path: path.name for path in folders}
    found = [
        item
        for path, condition in conditions.items()
        for item in _items_of(study, path, replace(facts, condition=condition))
    ]
    if not found:
        raise InputError("there is no file to import", where=folder, remedy="Put files there first")
    return [item for kind in _KINDS for item_kind, item in found if item_kind == kind]


_KINDS: Final = ("speech", "motion", "video", "other")
"""In the order of their import: speech adds the segments that motion and videos belong to."""


def _items_of(
    study: StudyFolder, folder: Path, facts: RecordingFacts
) -> Iterator[tuple[str, FolderItem]]:
    """Yield the items in a folder of files of one condition, each with its kind."""
    files = (path for path in sorted(folder.iterdir()) if path.is_file() and path.name[0] != ".")
    remaining = dict.fromkeys(files)

    def with_ending(endings: Sequence[str], stem: str = "") -> list[Path]:
        return [
            path for path in remaining if path.suffix.lower() in endings and stem in ("", path.stem)
        ]

    def item(store: Callable[[], list[str]], *files: Path) -> FolderItem:
        for path in files:
            remaining.pop(path, None)
        return FolderItem(files=files, store=store)

    table = folder / SEGMENTS_FILE
    if table in remaining:
        lines = table.read_text("utf-8", errors="replace").splitlines()
        cells = {cell.strip() for line in lines for cell in line.split(",")}
        named = [path for path in with_ending(SPEECH_ENDINGS) if path.name in cells]
        yield "speech", item(partial(import_speech, study, folder), table, *named)
    for speech in with_ending(SPEECH_ENDINGS):
        motions = with_ending(MOTION_ENDINGS, speech.stem)[:1]
        store = partial(_store_take, study, facts, next(iter(motions), None), speech)
        companions = with_ending(COMPANION_ENDINGS, speech.stem)
        yield "speech", item(store, *motions, speech, *companions)
    for motion in with_ending(MOTION_ENDINGS):
        companions = with_ending(COMPANION_ENDINGS, motion.stem)
        yield "motion", item(partial(_store_clip, study, facts, motion), motion, *companions)
    for video in with_ending((VIDEO_ENDING,)):
        yield "video", item(partial(_store_video, study, facts, video), video)
    for path in list(remaining):
        yield "other", item(partial(_refuse_unknown, path), path)


def _store_take(
    study: StudyFolder, facts: RecordingFacts, motion: Path | None, speech: Path
) -> list[str]:
    if facts.speaker is None or facts.emotion is None:
        raise InputError(
            "the speaker and the emotion are unknown",
            where=speech,
            remedy="Name the speaker and the emotion (--speaker, --emotion), or put a "
            f"{SEGMENTS_FILE} beside it that does",
        )
    condition = motion and _require_condition(facts, motion)
    take = Take(**vars(facts) | {"condition": condition}, motion=motion, speech=speech)
    return import_take(study, take)[1]


def _store_clip(study: StudyFolder, facts: RecordingFacts, motion: Path) -> list[str]:
    return import_clips(study, [motion], _require_condition(facts, motion), facts)


def _store_video(study: StudyFolder, facts: RecordingFacts, video: Path) -> list[str]:
    return import_video(study, video, _require_condition(facts, video))


def _require_condition(facts: RecordingFacts, path: Path) -> str:
    if facts.condition is None:
        raise InputError(
            "the condition is unknown",
            where=path,
            remedy="Name its condition (--condition), or put it into a folder of that name",
        )
    return facts.condition


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
