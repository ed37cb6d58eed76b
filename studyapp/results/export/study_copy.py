"""A copy of a study from which its report can be made again elsewhere."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pandas as pd

from motion.files import write_text
from motion.segment import Segment
from studyapp.session.served_study import described
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media
from studyapp.study.settings.study import Study

STIMULI: Final = (
    *("file", "shows", "conditions", "segment"),
    *("speech", "duration", "bytes", "sha256"),
)


def copy_study(folder: StudyFolder, study: Study, to: StudyFolder, *, videos: bool) -> list[str]:
    """Copy what a report of the study is made of, and return what could not be, in sentences.

    That is the study file as it is, byte for byte; speech, motion and feature networks, which
    metrics are measured from; and with `videos` the videos.
    """
    to.root.mkdir(parents=True)
    shutil.copyfile(folder.definition, to.definition)
    for file in _material(folder, study):
        _copy(folder, to, file)
    if folder.stimuli.exists():
        _copy(folder, to, folder.stimuli)
    if videos:
        for path in sorted(folder.videos.rglob("*.mp4")):
            _copy(folder, to, path)
    return [*_outside(folder, study)]


def _material(folder: StudyFolder, study: Study) -> Iterator[Path]:
    """Yield the files that metrics read, where the study has any."""
    table = folder.speech / "segments.csv"
    if table.exists():
        yield table
        segments = folder.segments()
        yield from (folder.speech / wav for wav in dict.fromkeys(s.wav for s in segments))
        annotated = (folder.semantics(segment.name) for segment in segments)
        yield from (file for file in annotated if file.is_file())
        for condition in dict.fromkeys((*study.conditions, study.catch.condition)):
            clips = (folder.clip(condition, segment.name) for segment in segments)
            yield from (clip for clip in clips if clip.is_file())
    yield from sorted(folder.evaluators.glob("*.safetensors"))
    matrix = study.video.expression_matrix
    if matrix and _is_within(folder, matrix):
        yield folder.root / matrix


def _outside(folder: StudyFolder, study: Study) -> Iterator[str]:
    """Say which files a report needs that may not, or cannot, be passed on."""
    if study.video.body:
        yield (
            f"The body {Path(study.video.body).name} is licensed and was not copied: whoever "
            "repeats the metrics needs a copy of their own at the path that study.toml names."
        )
    for one in study.evaluator:
        yield (
            f"The published evaluator {Path(one.file).name} is its authors' and was not copied: "
            "whoever repeats the metrics needs it at the path that study.toml names, or removes "
            "'evaluator' there."
        )
    matrix = study.video.expression_matrix
    if matrix and not _is_within(folder, matrix):
        yield (
            f"The expression matrix {Path(matrix).name} lies outside the study and was not "
            "copied: whoever repeats the metrics needs it at the path that study.toml names."
        )


def _is_within(folder: StudyFolder, given: str) -> bool:
    path = (folder.root / Path(given).expanduser()).resolve()
    return path.is_relative_to(folder.root.resolve()) and path.is_file()


def _copy(folder: StudyFolder, to: StudyFolder, file: Path) -> None:
    target = to.root / file.relative_to(folder.root)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(file, target)


def write_stimuli_list(
    path: Path, folder: StudyFolder, study: Study, segments: tuple[Segment, ...]
) -> None:
    """Write which videos participants were shown, with their SHA-256."""
    media = Media.of(folder, study)
    found = {content: media.find(content) for content in study.contents(segments)}
    rows = [
        (
            video.file.relative_to(folder.root).as_posix(),
            described(content),
            " ".join(stimulus.condition for stimulus in content),
            content[0].segment,
            content[0].speech or "n/a",
            f"{video.duration:.3f}",
            video.file.stat().st_size,
            sha256_of(video.file),
        )
        for content, video in found.items()
        if video is not None and video.file.is_file()
    ]
    table = pd.DataFrame(rows, columns=STIMULI)
    write_text(path, table.to_csv(sep="\t", index=False, lineterminator="\n"))


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file, read piece by piece."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
