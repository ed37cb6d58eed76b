"""Recordings of a study or of a folder, to train feature networks on."""

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from analysis.evaluators.training import ClipSource
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip
from motion.endings import MOTION_ENDINGS
from motion.errors import InputError
from motion.files import sha256_of
from motion.formats import read_clip, read_recorded
from motion.segment import SEGMENTS_FILE
from renderer.look import default_body
from studyapp.stimuli.shown_motion import shown_body
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import GROUND_TRUTH


@dataclass(frozen=True, kw_only=True, eq=False)
class Recordings:
    """Recorded motion to train on.

    Attributes
    ----------
    sources : tuple of ClipSource
        The clips.
    frozen : tuple of str
        Channels that are frozen.
    read_body : callable
        Reads the body of the clips' face, which takes a while.
    networks : Path
        Folder for networks trained on the clips.
    """

    sources: tuple[ClipSource, ...]
    frozen: tuple[str, ...]
    read_body: Callable[[], BodyModel]
    networks: Path


def recordings_of(data: Path, *, show_note: Callable[[str], None] | None = None) -> Recordings:
    """Return the ground truth of a study folder, or the recordings of a folder of motion files.

    Parameters
    ----------
    data : Path
        The folder.
    show_note : callable, optional
        With a folder of motion files: called with each note on a clip, when the clip is read.

    Raises
    ------
    InputError
        If the folder does not exist or has no motion.
    """
    if not data.is_dir():
        raise InputError("there is no such folder", where=data, remedy="Check the path")
    study = StudyFolder(data)
    if study.definition.exists():
        return _study_recordings(study)
    return _folder_recordings(data, show_note)


def _study_recordings(folder: StudyFolder) -> Recordings:
    study = folder.study()
    segments = folder.segments()
    files = {segment: folder.clip(GROUND_TRUTH, segment.name) for segment in segments}
    sources = tuple(
        ClipSource(
            name=segment.name,
            recording=segment.wav,
            emotion=segment.emotion,
            sha256=sha256_of(path),
            read=partial(read_clip, path),
        )
        for segment, path in files.items()
        if path.is_file()
    )
    if not sources:
        raise InputError(
            f"condition {GROUND_TRUTH!r} has no motion",
            where=folder.root / "motion" / GROUND_TRUTH,
            remedy="Import recordings with 'motionjury import'",
        )
    return Recordings(
        sources=sources,
        frozen=tuple(study.freeze),
        read_body=partial(shown_body, folder, study),
        networks=folder.evaluators,
    )


def _folder_recordings(folder: Path, show_note: Callable[[str], None] | None) -> Recordings:
    paths = sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and path.suffix.lower() in MOTION_ENDINGS
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    )
    if not paths:
        raise InputError(
            "there is no motion file in the folder",
            where=folder,
            remedy=f"Give a folder of {', '.join(MOTION_ENDINGS)} files, or a study folder",
        )
    labels = _labels(folder / SEGMENTS_FILE)
    sources = []
    for path in paths:
        recording, emotion = labels.get(path.stem, (path.stem, ""))
        sources.append(
            ClipSource(
                name=path.relative_to(folder).as_posix(),
                recording=recording,
                emotion=emotion,
                sha256=sha256_of(path),
                read=partial(_read, path, show_note),
            )
        )
    return Recordings(
        sources=tuple(sources),
        frozen=(),
        read_body=lambda: read_body(default_body()),
        networks=Path(),
    )


def _read(path: Path, show_note: Callable[[str], None] | None) -> MotionClip:
    clip, notes = read_recorded(path)
    if show_note is not None:
        for note in notes:
            show_note(note)
    return clip


def _labels(table: Path) -> Mapping[str, tuple[str, str]]:
    """Return the recording and the emotion of each motion file in a table; empty without it.

    The table needs only the columns ``name`` and ``emotion``. Segments with the same ``wav`` belong
    to one recording.
    """
    if not table.is_file():
        return {}
    try:
        with table.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(file))
        return {
            row["name"].strip(): (row.get("wav", row["name"]).strip(), row["emotion"].strip())
            for row in rows
        }
    except (KeyError, AttributeError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            "the table is not CSV in UTF-8 with the columns name and emotion in every row",
            where=table,
            remedy="Give the name of each motion file, without ending, and its emotion",
        ) from error
