"""Automatic metrics of a study, or of folders of motion files."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from analysis.evaluators.feature_networks import PublishedFile, Source
from analysis.measurement.measured_clips import Excerpt, LandmarkBody
from analysis.measurement.measuring import study_metrics
from analysis.measurement.presets import combined
from analysis.metrics.scores import StudyMetrics
from motion.endings import MOTION_ENDINGS, SPEECH_ENDINGS
from motion.errors import InputError
from motion.segment import SEGMENTS_FILE, read_segments
from renderer.look import default_body
from studyapp.stimuli.shown_motion import body_file, expression_matrix_file
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import GROUND_TRUTH, Study

Show = Callable[[int, int], None]

_SEMANTICS: Final = (".txt",)
_NETWORK: Final = ".safetensors"
MEASURED_BODY: Final = "mannequin"
"""The avatar for penetration of the arms into the body; it has no loose clothes."""


def measure_study(
    folder: StudyFolder,
    *,
    presets: Sequence[str],
    processes: int,
    evaluators: Sequence[Source] = (),
    penetration: bool = False,
    on_progress: Show | None = None,
) -> StudyMetrics:
    """Measure all conditions of a study that have motion files.

    The recordings are the condition ``ground_truth``, if there is one. Joint positions and features
    are cached in the study folder.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    presets, processes, on_progress
        The same as for `analysis.measurement.measuring.study_metrics`.
    evaluators : sequence of Path or PublishedFile
        Feature networks besides the study's own (`study_evaluators`).
    penetration : bool
        Also measure how far arms enter the body.

    Raises
    ------
    InputError
        If the study, its segments or a network cannot be read, or no condition has a motion file.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    shown = dict.fromkeys((*study.conditions, study.catch.condition))
    clips = {
        condition: {
            segment.name: folder.clip(condition, segment.name)
            for segment in segments
            if folder.clip(condition, segment.name).is_file()
        }
        for condition in shown
    }
    clips = {condition: files for condition, files in clips.items() if files}
    if not clips:
        raise InputError(
            "the study has no motion file",
            where=folder.root / "motion",
            remedy="Make motion with 'motionjury generate', or import it with 'motionjury import'",
        )
    return study_metrics(
        clips,
        {
            segment.name: (folder.recording(segment), segment.start, segment.end)
            for segment in segments
        },
        frozen=study.freeze,
        recorded=clips.get(GROUND_TRUTH),
        semantics={
            segment.name: folder.semantics(segment.name)
            for segment in segments
            if folder.semantics(segment.name).is_file()
        },
        emotions={segment.name: segment.emotion for segment in segments},
        evaluators=(*study_evaluators(folder, study), *evaluators),
        face=_landmark_body(folder, presets) if GROUND_TRUTH in clips else None,
        penetrable=default_body(MEASURED_BODY) if penetration else None,
        presets=presets,
        kept=folder.joint_positions,
        processes=processes,
        on_progress=on_progress,
    )


def study_evaluators(folder: StudyFolder, study: Study) -> tuple[Source, ...]:
    """Return the networks in the study's folder ``evaluators``, and those that it names."""
    return (
        *sorted(folder.evaluators.glob(f"*{_NETWORK}")),
        *(
            PublishedFile(
                preset=one.preset,
                file=folder.root / Path(one.file).expanduser(),
                statistics=folder.root / Path(one.statistics).expanduser()
                if one.statistics
                else None,
            )
            for one in study.evaluator
        ),
    )


def measure_folders(
    generated: Path,
    reference: Path | None,
    speech: Path | None,
    *,
    presets: Sequence[str],
    processes: int,
    evaluators: Sequence[Source] = (),
    penetration: bool = False,
    semantics: Path | None = None,
    cache: Path | None = None,
    file_rate: float | None = None,
    on_progress: Show | None = None,
) -> StudyMetrics:
    """Measure the motion files of a folder as one condition, or of each sub-folder.

    Parameters
    ----------
    generated : Path
        ``<segment>.npz`` (or .npy, .bvh), or ``<condition>/<segment>.npz``.
    reference : Path or None
        ``<segment>.npz`` with recorded motion of the same speech, which is measured too.
    speech : Path or None
        ``<segment>.wav``, or a table ``segments.csv`` with its recordings.
    presets, processes, on_progress
        The same as for `analysis.measurement.measuring.study_metrics`.
    evaluators : sequence of Path or PublishedFile
        Feature networks.
    penetration : bool
        Also measure how far arms enter the body.
    semantics : Path or None
        ``<segment>.txt`` with BEAT's semantic scores of the reference.
    cache : Path or None
        Cache of joint positions and features.
    file_rate : float or None
        Frame rate of all motion files, overriding their own.

    Raises
    ------
    InputError
        If a folder is missing or empty, or two files have the same segment.
    """
    clips = _conditions(generated)
    recorded = _files(reference, MOTION_ENDINGS, "motion") if reference else None
    if reference is not None and recorded is not None:
        name = reference.resolve().name
        if name in clips:
            raise InputError(
                f"a generated condition has the name of the reference, {name!r}",
                where=reference,
                remedy="Rename one of the folders",
            )
        if not any(set(recorded) & set(files) for files in clips.values()):
            raise InputError(
                "no reference has the name of a generated motion",
                where=reference,
                remedy="Use the same names for files of the same speech in both folders",
            )
        clips = {name: recorded, **clips}
    return study_metrics(
        clips,
        _speech(speech) if speech is not None else {},
        recorded=recorded,
        semantics=_files(semantics, _SEMANTICS, "semantic score") if semantics else None,
        emotions=_emotions(speech) if speech is not None else None,
        evaluators=evaluators,
        face=LandmarkBody(path=default_body())
        if recorded is not None and combined(presets).landmark_errors
        else None,
        penetrable=default_body(MEASURED_BODY) if penetration else None,
        presets=presets,
        own_files=False,
        file_rate=file_rate,
        kept=cache,
        processes=processes,
        on_progress=on_progress,
    )


def _conditions(folder: Path) -> dict[str, dict[str, Path]]:
    """Return the motion files of `folder`, or of each folder in it, by condition."""
    _require_folder(folder)
    sub_folders = sorted(path for path in folder.iterdir() if path.is_dir() and path.name[0] != ".")
    if not _list_files(folder, MOTION_ENDINGS) and any(
        _list_files(path, MOTION_ENDINGS) for path in sub_folders
    ):
        return {
            path.name: _files(path, MOTION_ENDINGS, "motion")
            for path in sub_folders
            if _list_files(path, MOTION_ENDINGS)
        }
    return {folder.resolve().name: _files(folder, MOTION_ENDINGS, "motion")}


def _files(folder: Path, endings: Sequence[str], kind: str) -> dict[str, Path]:
    """Return the files of `folder` by segment."""
    _require_folder(folder)
    files: dict[str, Path] = {}
    for path in _list_files(folder, endings):
        if path.stem in files:
            raise InputError(
                f"{files[path.stem].name} and {path.name} have the same segment",
                where=folder,
                remedy="Keep one of them",
            )
        files[path.stem] = path
    if not files:
        raise InputError(
            f"there is no {kind} file in the folder",
            where=folder,
            remedy=f"Give a folder of {', '.join(endings)} files",
        )
    return files


def _list_files(folder: Path, endings: Sequence[str]) -> list[Path]:
    return sorted(
        path
        for path in folder.iterdir()
        if path.suffix.lower() in endings and path.name[0] != "." and path.is_file()
    )


def _speech(folder: Path) -> dict[str, Excerpt]:
    _require_folder(folder)
    if (folder / SEGMENTS_FILE).is_file():
        return {
            segment.name: (folder / segment.wav, segment.start, segment.end)
            for segment in read_segments(folder)
        }
    files = _files(folder, SPEECH_ENDINGS, "speech")
    return {segment: (path, 0.0, math.inf) for segment, path in files.items()}


def _emotions(folder: Path) -> dict[str, str]:
    """Return the emotion of each segment; empty without a table."""
    if not (folder / SEGMENTS_FILE).is_file():
        return {}
    return {segment.name: segment.emotion for segment in read_segments(folder)}


def _landmark_body(folder: StudyFolder, presets: Sequence[str]) -> LandmarkBody | None:
    """Return the study's body if a preset needs face landmarks."""
    if not combined(presets).landmark_errors:
        return None
    study = folder.study()
    return LandmarkBody(
        path=body_file(folder, study), expression_matrix=expression_matrix_file(folder, study)
    )


def _require_folder(folder: Path) -> None:
    if not folder.is_dir():
        raise InputError("there is no such folder", where=folder, remedy="Check the path")
