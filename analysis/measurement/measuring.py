"""Measuring all clips of all conditions, of a study or of a folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import TypeVar

from analysis.evaluators.feature_networks import Source, networks
from analysis.measurement.condition_scores import (
    condition_scores,
    network_scores,
    recorded_conditions,
)
from analysis.measurement.measured_clips import (
    Excerpt,
    LandmarkBody,
    SeenMotion,
    Setup,
    penetrable_body,
)
from analysis.measurement.presets import REPORT, Preset, combined
from analysis.measurement.recorded_spread import recorded_spread
from analysis.measurement.segment_scores import SegmentFiles, recorded_extent, segment_scores
from analysis.metrics.kinematics import common_frame_rate
from analysis.metrics.scores import ClipScore, StudyMetrics
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.clip_npz import read_frame_rate
from motion.processes import ProcessPool

Progress = Callable[[int, int], None]
"""Called with the number of finished tasks, and of all tasks."""

_Result = TypeVar("_Result")


def study_metrics(
    clips: Mapping[str, Mapping[str, Path]],
    speech: Mapping[str, Excerpt],
    *,
    frozen: Collection[str] = (),
    recorded: Mapping[str, Path] | None = None,
    semantics: Mapping[str, Path] | None = None,
    emotions: Mapping[str, str] | None = None,
    evaluators: Iterable[Source] = (),
    face: LandmarkBody | None = None,
    penetrable: Path | None = None,
    presets: Iterable[str] = (REPORT,),
    own_files: bool = True,
    file_rate: float | None = None,
    kept: Path | None = None,
    processes: int = 1,
    on_progress: Progress | None = None,
) -> StudyMetrics:
    """Measure the clips of every condition at one frame rate, on one body.

    Motion files that cannot be used are left out and listed.

    Parameters
    ----------
    clips : mapping of condition to mapping of segment to path
        Motion files.
    speech : mapping of segment to (recording, start, end)
        The speech of each segment; without it there is no beat alignment.
    frozen : collection of str
        Channels that the study keeps still in its videos.
    recorded : mapping of segment to path, optional
        Recorded motion of the same speech, for metrics that compare with it.
    semantics : mapping of segment to path, optional
        Gestures of the recordings that carry meaning (`motion.formats.beat_tracks`).
    emotions : mapping of segment to str, optional
        The emotion of each segment's speech, for gesture emotion accuracy.
    evaluators : iterable of Path or PublishedFile
        Feature networks made by ``motionjury train evaluator``, or published ones; all of them are
        used, whatever the presets request.
    face : LandmarkBody, optional
        The body of the face landmarks, for metrics that compare them with recorded ones.
    penetrable : Path, optional
        The body for self-penetration; without it there is none.
    presets : iterable of str
        Names in `analysis.measurement.presets.PRESETS`.
    own_files : bool
        Whether the motion files belong to a study and are read as they are; other files may have
        any format and are converted to the study's conventions.
    file_rate : float, optional
        Frames per second of all motion files, in place of the stated rate.
    kept : Path, optional
        Folder that keeps joint positions, features and the like between runs.
    processes : int
        How many segments are measured in parallel.
    on_progress : callable, optional
        Called with the number of finished steps, and of all; a step is a segment, or a recording
        that is measured first.

    Raises
    ------
    InputError
        If a network cannot be used.
    """
    preset = combined(presets)
    feature_networks = networks(evaluators)
    if penetrable is not None:
        penetrable_body(penetrable)
    recordings = dict(recorded or {})
    if not recordings:
        preset = preset.without_recordings()
    rates, usable, skipped = _frame_rates([*clips.values(), recordings], own_files, file_rate)
    segments = [
        SegmentFiles(
            segment=name,
            clips={c: paths[name] for c, paths in clips.items() if paths.get(name) in usable},
            recorded=path if (path := recordings.get(name)) in usable else None,
            speech=speech.get(name),
            semantics=(semantics or {}).get(name),
        )
        for name in sorted({segment for paths in clips.values() for segment in paths})
    ]
    segments = [files for files in segments if files.clips]
    if not segments:
        return StudyMetrics(frame_rate=math.nan, clips=(), conditions=(), skipped=tuple(skipped))
    setup = Setup(
        frame_rate=common_frame_rate(rates),
        motion=SeenMotion(frozen=tuple(frozen), own_files=own_files, file_rate=file_rate),
        preset=preset,
        kept=kept,
        face=face,
    )
    recorded_files = sorted({files.recorded for files in segments if files.recorded is not None})
    if not preset.needs_recorded_spread:
        recorded_files = []
    steps = count(1)

    def collect(results: Iterable[_Result]) -> list[_Result]:
        collected = []
        for result in results:
            collected.append(result)
            if on_progress is not None:
                on_progress(next(steps), len(recorded_files) + len(segments))
        return collected

    with ProcessPool(processes) if processes > 1 else nullcontext() as pool:
        run = map if pool is None else pool.map
        extents = collect(run(partial(recorded_extent, setup=setup), recorded_files))
        setup = replace(
            setup,
            spread=recorded_spread(extent for extent in extents if extent is not None),
            networks=feature_networks,
            penetrable=penetrable,
        )
        measured = collect(run(partial(segment_scores, setup=setup), segments))
    skipped += {str(e): e for segment in measured for e in segment.skipped}.values()
    recordings_shown = recorded_conditions(clips, segments)
    by_network = [
        network_scores(network, clips, measured, recordings_shown, emotions or {})
        for network in feature_networks
    ]
    scores = [
        ClipScore(condition=condition, segment=segment.segment, result=result)
        for segment in measured
        for condition, clip in segment.clips.items()
        for result in clip.scores
    ]
    all_scores = [*scores, *(score for network in by_network for score in network.clips)]
    return StudyMetrics(
        frame_rate=setup.frame_rate,
        clips=tuple(
            score for condition in clips for score in all_scores if score.condition == condition
        ),
        conditions=tuple(
            condition_scores(tuple(clips), scores, measured, setup, by_network, recordings_shown)
        ),
        skipped=tuple(skipped),
        notes=tuple(note for segment in measured for note in segment.notes),
        remarks=tuple(_remarks(segments, preset, bool(recordings))),
        confusions=tuple(confusion for network in by_network for confusion in network.confusions),
    )


def _frame_rates(
    files: Iterable[Mapping[str, Path]], own_files: bool, file_rate: float | None
) -> tuple[list[float], set[Path], list[InputError]]:
    """Return the frame rates that occur, the files that have one, and those that do not."""
    rates: set[float] = set()
    usable: set[Path] = set()
    skipped: list[InputError] = []
    for path in dict.fromkeys(path for paths in files for path in paths.values()):
        try:
            if file_rate is not None:
                rates.add(file_rate)
            elif own_files or path.suffix == ".npz":
                rates.add(read_frame_rate(path))
            else:
                rates.add(read_motion(path).frame_rate)
            usable.add(path)
        except InputError as error:
            skipped.append(error)
    return sorted(rates), usable, skipped


def _remarks(
    segments: Sequence[SegmentFiles], preset: Preset, with_recordings: bool
) -> Iterator[str]:
    """Yield which segments lack speech or a recording."""
    no_speech = [files.segment for files in segments if files.speech is None]
    if preset.beats and no_speech:
        yield f"no beat alignment without speech: {_named(no_speech, len(segments))}"
    no_recording = [files.segment for files in segments if files.recorded is None]
    if with_recordings and no_recording:
        yield f"no comparison without a recording: {_named(no_recording, len(segments))}"
    elif no_recording:
        yield "no recordings are given, so nothing is compared with them"


def _named(segments: Sequence[str], of_all: int) -> str:
    """Return the number of segments and the first few names."""
    names = ", ".join(segments[:3]) + (", …" if len(segments) > 3 else "")
    return f"{len(segments)} of {of_all} segments ({names})"
