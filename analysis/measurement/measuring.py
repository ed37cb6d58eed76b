"""Measuring all clips of all conditions, of a study or of a folder."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Final, TypeVar

import numpy as np

from analysis.evaluators.feature_networks import COMMANDS, Network, Source, networks
from analysis.measurement.feature_scores import (
    FeatureScores,
    feature_scores,
    scores_without_network,
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
from analysis.measurement.segment_scores import (
    ClipMeasurements,
    SegmentFiles,
    SegmentScores,
    pose_settings,
    recorded_extent,
    segment_scores,
)
from analysis.metrics.diversity import mean_pair_distance, motion_features
from analysis.metrics.kinematics import common_frame_rate
from analysis.metrics.scores import (
    ClipScore,
    ConditionScore,
    Metric,
    MetricResult,
    StudyMetrics,
    clip_means,
    whole_condition,
)
from motion.arrays import Floats32
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.clip_npz import read_frame_rate
from motion.processes import ProcessPool

Progress = Callable[[int, int], None]
"""Called with the number of finished tasks, and of all tasks."""

_EXPRESSIONS: Final = "mean distance between clips (expressions)"

_FACES: Final = {52: "ARKit weights", 100: "SMPL-X expression coefficients"}

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
    recordings_shown = _recorded_conditions(clips, segments)
    by_network = [
        _network_scores(network, clips, measured, recordings_shown, emotions or {})
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
            _condition_scores(tuple(clips), scores, measured, setup, by_network, recordings_shown)
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


def _recorded_conditions(
    conditions: Iterable[str], segments: Sequence[SegmentFiles]
) -> frozenset[str]:
    """Return the conditions whose motion is the recorded one."""
    return frozenset(
        condition
        for condition in conditions
        if all(
            files.clips[condition] == files.recorded
            for files in segments
            if condition in files.clips
        )
    )


def _network_scores(
    network: Network,
    conditions: Iterable[str],
    measured: Sequence[SegmentScores],
    recordings: frozenset[str],
    emotions: Mapping[str, str],
) -> FeatureScores:
    """Return the scores of one network."""
    by_condition = {
        condition: {
            segment.segment: segment.clips[condition].features[network.name]
            for segment in measured
            if condition in segment.clips
        }
        for condition in conditions
    }
    recorded = {
        segment.segment: segment.recorded.features[network.name]
        for segment in measured
        if segment.recorded is not None
    }
    return feature_scores(
        network,
        {condition: clips for condition, clips in by_condition.items() if clips},
        recorded,
        recordings=recordings,
        emotions=emotions,
    )


def _condition_scores(
    conditions: Sequence[str],
    scores: Sequence[ClipScore],
    measured: Sequence[SegmentScores],
    setup: Setup,
    by_network: Sequence[FeatureScores],
    recordings: Collection[str],
) -> Iterator[ConditionScore]:
    """Yield all scores of each condition: means over clips, distances, scores of networks."""
    available = {network.name.partition(", ")[0] for network in setup.networks}
    for condition in conditions:
        clips = [segment.clips[condition] for segment in measured if condition in segment.clips]
        yield from clip_means(condition, [s for s in scores if s.condition == condition])
        yield from _distances(condition, clips, setup)
        for network in by_network:
            yield from (score for score in network.conditions if score.condition == condition)
        for name in setup.preset.networks:
            if name not in available:
                yield from scores_without_network(
                    name, COMMANDS[name], condition, len(clips), recorded=condition in recordings
                )


def _distances(
    condition: str, clips: Sequence[ClipMeasurements], setup: Setup
) -> Iterator[ConditionScore]:
    """Yield the distances between the clips of a condition that the preset asks for."""
    bodies = [clip.upper_body for clip in clips if clip.upper_body is not None]
    if bodies:
        yield whole_condition(condition, _pair_distance(bodies, setup), len(bodies))
    if setup.preset.expression_distance and clips:
        faces = [clip.face for clip in clips if clip.face is not None]
        yield whole_condition(condition, _expression_distance(faces, setup), len(clips))


def _pair_distance(clips: Sequence[Floats32], setup: Setup) -> MetricResult:
    return mean_pair_distance(
        motion_features([clip.astype(np.float64) for clip in clips]),
        settings=pose_settings(setup.frame_rate)
        | {"distance": f"root mean square over frames and joints, {_cut(clips, setup.frame_rate)}"},
    )


def _cut(clips: Sequence[Floats32], frame_rate: float) -> str:
    return f"clips cut to the shortest, {min(map(len, clips)) / frame_rate:.2f} s"


def _expression_distance(clips: Sequence[Floats32], setup: Setup) -> MetricResult:
    kinds = {clip.shape[1] for clip in clips}
    reason = ""
    if "face" in setup.motion.frozen:
        reason = "the study holds the face still"
    elif not clips:
        reason = "no clip has a face"
    elif len(kinds) > 1:
        reason = "some clips have ARKit weights and others SMPL-X coefficients"
    if reason:
        return Metric(_EXPRESSIONS, better="near the reference").missing(reason)
    return mean_pair_distance(
        motion_features([clip[..., None].astype(np.float64) for clip in clips]),
        name=_EXPRESSIONS,
        unit="",
        settings={
            "face": _FACES[kinds.pop()],
            "frame rate": f"{setup.face_rate:g} fps",
            "distance": f"root mean square over frames and weights, {_cut(clips, setup.face_rate)}",
        },
    )
