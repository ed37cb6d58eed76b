"""The parts of a folder for another lab: tables in BIDS, a copy of the study, its page."""

import platform
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any, Final

import pandas as pd

from motion.errors import listed
from motion.files import harmless_frame, sha256_of, write_text
from motion.segment import Segment
from studyapp.researchers.pseudonyms import FOLDER
from studyapp.results.export.codebook import as_json, column_labels
from studyapp.results.export.columns import PARTICIPANT, Column, TableColumns, as_text, bids_column
from studyapp.session.served_study import describe_content
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media
from studyapp.study.settings.study import Study

BIDS_VERSION: Final = "1.11.0"
MISSING: Final = "n/a"

LEFT_OUT: Final = ("answered_at", "consented_at")
"""Times that add nothing to the others."""

PARTICIPANT_ID: Final = replace(
    PARTICIPANT,
    name="participant_id",
    meaning="The participant: sub- and a pseudonym, which is a keyed hash. Without the key, which "
    "stays with the researchers, it leads back to nobody.",
)


def folder_name(pseudonym: str) -> str:
    """Return a participant's name in BIDS, which also names the folder."""
    return f"{FOLDER}{pseudonym}"


def bids_table(
    frame: pd.DataFrame, about: TableColumns, consents: Mapping[str, pd.Timestamp]
) -> tuple[pd.DataFrame, TableColumns]:
    """Return a typed table with BIDS headings, and seconds instead of times.

    Parameters
    ----------
    frame, about
        A table with the column ``participant``.
    consents : mapping of pseudonym to Timestamp
        Time of each participant's consent.
    """
    began = pd.to_datetime(frame["participant"].map(dict(consents)), utc=True)
    columns: list[Column] = [PARTICIPANT_ID]
    cells: dict[str, Any] = {"participant_id": frame["participant"].map(folder_name)}
    for column in about.columns:
        if column.name in LEFT_OUT or column.name == "participant":
            continue
        own = bids_column(column)
        columns.append(own)
        cells[own.name] = (
            (frame[column.name] - began).dt.total_seconds().round(3)
            if column.type == "moment"
            else frame[column.name]
        )
    return pd.DataFrame(cells), replace(about, columns=tuple(columns))


def write_tsv(path: Path, frame: pd.DataFrame, about: TableColumns) -> None:
    """Write a typed table in the format of BIDS."""
    cells = harmless_frame(as_text(frame, about, missing=MISSING))
    # Many readers would take a line break within a cell as the end of its row.
    cells = cells.map(lambda cell: " ".join(cell.split()) if isinstance(cell, str) else cell)
    write_text(path, cells.to_csv(index=False, sep="\t", lineterminator="\n"))


def write_descriptions(
    path: Path,
    about: TableColumns,
    study: Study,
    *,
    more: Mapping[str, Any] | None = None,
    labels: Mapping[str, Mapping[str, str]] | None = None,
) -> None:
    """Write the descriptions of a table's columns.

    Parameters
    ----------
    more : mapping, optional
        Descriptions of the whole table.
    labels : mapping of column name to mapping, optional
        Meanings of values, for columns without labels in the study.
    """
    write_text(
        path,
        as_json(
            dict(more or {})
            | {column.name: _described(column, study, labels or {}) for column in about.columns}
        ),
    )


def _described(
    column: Column, study: Study, labels: Mapping[str, Mapping[str, str]]
) -> dict[str, Any]:
    missing = f" {MISSING} where {column.missing}." if column.missing else ""
    free = " Free text." if column.free_text else ""
    details: dict[str, Any] = {"Description": f"{column.meaning}{missing}{free}"}
    if column.unit:
        details["Units"] = column.unit
    values = labels.get(column.name) or column_labels(study, column.name)
    if values:
        details["Levels"] = dict(values)
    return details


def environment() -> dict[str, Any]:
    """Return the versions of the program, of Python, and of all installed packages."""
    packages = {package.metadata["Name"]: package.version for package in metadata.distributions()}
    return {
        "motionjury": metadata.version("motionjury"),
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "packages": dict(sorted(packages.items())),
    }


STIMULI: Final = (
    *("file", "shows", "conditions", "segment"),
    *("speech", "duration", "bytes", "sha256"),
)


def copy_study(folder: StudyFolder, study: Study, to: StudyFolder, *, videos: bool) -> list[str]:
    """Copy what a report of the study needs, and return sentences about what is missing.

    This is the study file, unchanged; the speech, motion and feature networks of the metrics; and
    with `videos`, the videos.
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
    remarks = []
    if outside := [Path(name).name for name in _outside(folder, study)]:
        remarks.append(
            f"Not copied, as not part of the study: {listed(outside)}. To reproduce the metrics, "
            "one needs them at their paths in study.toml."
        )
    if not videos and any(to.root.glob("motion/*/*.npz")) and not to.speech.exists():
        remarks.append(
            "Whoever repeats the metrics also needs the finished videos (--with-videos), by which "
            "alone segments are known."
        )
    return remarks


def _material(folder: StudyFolder, study: Study) -> Iterator[Path]:
    """Yield the files that metrics read."""
    table = folder.speech / "segments.csv"
    segments: Sequence[Segment] = ()
    if table.exists():
        yield table
        segments = folder.segments()
    elif folder.has_segments(study):
        segments = folder.segments_of(study)
    yield from (folder.speech / wav for wav in dict.fromkeys(s.wav for s in segments) if wav)
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
    """Yield the files that a report needs but that belong to others, or lie outside the study."""
    if study.video.body:
        yield study.video.body
    yield from (evaluator.file for evaluator in study.evaluator)
    matrix = study.video.expression_matrix
    if matrix and not _is_within(folder, matrix):
        yield matrix


def _is_within(folder: StudyFolder, name: str) -> bool:
    path = (folder.root / Path(name).expanduser()).resolve()
    return path.is_relative_to(folder.root.resolve()) and path.is_file()


def _copy(folder: StudyFolder, to: StudyFolder, file: Path) -> None:
    target = to.root / file.relative_to(folder.root)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(file, target)


def write_stimuli_list(
    path: Path, folder: StudyFolder, study: Study, segments: tuple[Segment, ...]
) -> None:
    """Write the list of participants' videos with their SHA-256."""
    media = Media.of(folder, study)
    videos = {content: media.find(content) for content in study.contents(segments)}
    rows = [
        (
            video.file.relative_to(folder.root).as_posix(),
            describe_content(content),
            " ".join(stimulus.condition for stimulus in content),
            content[0].segment,
            content[0].speech or "n/a",
            f"{video.duration:.3f}",
            video.file.stat().st_size,
            sha256_of(video.file),
        )
        for content, video in videos.items()
        if video is not None and video.file.is_file()
    ]
    table = pd.DataFrame(rows, columns=STIMULI)
    write_text(path, table.to_csv(sep="\t", index=False, lineterminator="\n"))
