"""Measuring all clips of all conditions, over what participants saw or a folder holds."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from analysis.evaluators.feature_networks import Network, Source, command_for, networks
from analysis.measurement.clip_distances import distances_between_clips, distances_of_speeds
from analysis.measurement.conditions import (
    ConditionScore,
    StudyMetrics,
    clip_means,
)
from analysis.measurement.feature_scores import FeatureScores, scores_without_network
from analysis.measurement.joint_motion import JointMotionStore
from analysis.measurement.kept_onsets import forget_other_onsets
from analysis.measurement.measured_clips import Bench, LandmarkBody, SkippedFile, kept_landmarks
from analysis.measurement.passes import (
    depths_of_files,
    features_of_files,
    motions,
    penetrations,
    recorded_conditions,
    scores_of_network,
)
from analysis.measurement.penetration_of_files import DepthsOf
from analysis.measurement.presets import REPORT, Preset, combined
from analysis.measurement.recorded_spread import ClipExtent, recorded_spread
from analysis.measurement.seen_motion import SeenMotion
from analysis.measurement.segment_scores import (
    ClipScore,
    Excerpt,
    SegmentFiles,
    SegmentScores,
    recorded_extent,
    segment_scores,
)
from analysis.measurement.workers import Show, Steps, Workers
from analysis.metrics.joint_positions import common_frame_rate
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.clip_npz import read_frame_rate


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
    skip_unusable: bool = False,
    store: JointMotionStore | None = None,
    processes: int = 1,
    on_progress: Show | None = None,
) -> StudyMetrics:
    """Measure the clips of every condition at one frame rate, on one body.

    Parameters
    ----------
    clips : mapping of condition to mapping of segment to path
        Motion files.
    speech : mapping of segment to (recording, start, end)
        What each segment says; a segment without speech gets no beat alignment.
    frozen : collection of str
        Channels that the study holds still in its videos.
    recorded : mapping of segment to path, optional
        Recorded motion of the same speech, for metrics that compare with it.
    semantics : mapping of segment to path, optional
        Which gestures of the recordings carry meaning (`motion.formats.semantic_txt`).
    emotions : mapping of segment to str, optional
        Which emotion each segment is spoken with, for gesture emotion accuracy.
    evaluators : iterable of Path or PublishedFile
        Feature networks that ``motionjury train evaluator`` has made, or published ones; all of
        them are measured with, whatever the presets ask for.
    face : LandmarkBody, optional
        Whose face landmarks are on, for metrics that compare them with recorded ones.
    penetrable : Path, optional
        A body whose arms are looked for inside it; without it there is no self-penetration.
    presets : iterable of str
        Names in `analysis.measurement.presets.PRESETS`.
    own_files : bool
        Whether the motion files are a study's own, read as they stand; files from elsewhere are of
        any format and put into the study's world.
    file_rate : float, optional
        Frames per second of all motion files, in place of what they state.
    skip_unusable : bool
        Whether files that cannot be used are left out and named, rather than an error.
    store : JointMotionStore, optional
        Where joint positions and features are kept between runs; what is kept under the settings
        of this run, but not used by it, is removed.
    processes : int
        How many segments are measured at once.
    on_progress : callable, optional
        Called with steps done and all steps: a step is a segment, or a file that is looked at
        beforehand or with a network.

    Raises
    ------
    InputError
        If a preset is unknown, a network cannot be used, or if a file cannot be used and is not
        to be skipped.
    """
    preset = combined(presets)
    given = networks(evaluators)
    recordings = dict(recorded or {})
    if not recordings:
        preset = preset.without_recordings()
    rates, usable, skipped = _frame_rates([*clips.values(), recordings], own_files, file_rate)
    found = [
        _segment(name, clips, recordings, speech, semantics or {}, usable)
        for name in _segments(clips)
    ]
    found = [files for files in found if files.clips]
    if not skip_unusable and skipped:
        raise skipped[0].error()
    if not found:
        return StudyMetrics(frame_rate=math.nan, clips=(), conditions=(), skipped=tuple(skipped))
    motion = SeenMotion(frozen=tuple(frozen), own_files=own_files, file_rate=file_rate)
    bench = Bench(
        frame_rate=common_frame_rate(rates), motion=motion, preset=preset, store=store, face=face
    )
    folder = store.folder if store is not None else None
    inside = DepthsOf.on(penetrable, motion, folder) if penetrable is not None else None
    recorded_files = sorted({files.recorded for files in found if files.recorded is not None})
    looked_at = recorded_files if preset.needs_recorded_spread else []
    motion_files = sorted({path for files in found for path in motions(files)})
    passes = len(given) + (inside is not None)
    steps = Steps(len(looked_at) + len(found) + passes * len(motion_files), on_progress)
    with Workers(processes) as workers:
        if looked_at:
            extents = workers.each(_ExtentOf(bench), looked_at, steps.of(looked_at))
            bench = replace(bench, spread=recorded_spread(e for e in extents if e is not None))
        measured = workers.each(_ScoresOf(bench), found, steps.of(found))
        features = {
            network.name: features_of_files(network, bench, motion_files, workers, steps)
            for network in given
        }
        depths = depths_of_files(inside, motion_files, workers, steps) if inside is not None else {}
    skipped += list(dict.fromkeys(file for one in measured for file in one.skipped))
    if not skip_unusable and skipped:
        raise skipped[0].error()
    if store is not None:
        _forget_others(store, bench, {place for one in measured for place in one.kept})
    scores = [score for one in measured for score in one.scores]
    if inside is not None:
        scores += penetrations(found, depths, inside.described)
    damaged = {file.where for file in skipped}
    seen = [
        scores_of_network(network, tuple(clips), found, features[network.name], emotions, damaged)
        for network in given
    ]
    return StudyMetrics(
        frame_rate=bench.frame_rate,
        clips=tuple(_by_condition(clips, scores, seen)),
        conditions=tuple(
            _condition_scores(
                tuple(clips),
                scores,
                measured,
                bench,
                given,
                seen,
                recorded_conditions(clips, found),
            )
        ),
        skipped=tuple(skipped),
        remarks=tuple(_remarks(found, preset, bool(recordings))),
        confusions=tuple(confusion for one in seen for confusion in one.confusions),
    )


def _forget_others(store: JointMotionStore, bench: Bench, used: Collection[Path]) -> None:
    """Remove what is kept under the settings of this run, but not `used` by it."""
    store.forget_others(used, bench.frame_rate, bench.motion)
    forget_other_onsets(store.folder)
    if bench.preset.needs_landmarks:
        kept_landmarks(store.folder).forget(bench.landmark_settings, used)


@dataclass(frozen=True)
class _ScoresOf:
    bench: Bench

    def __call__(self, files: SegmentFiles) -> SegmentScores:
        return segment_scores(files, self.bench)


@dataclass(frozen=True)
class _ExtentOf:
    bench: Bench

    def __call__(self, path: Path) -> ClipExtent | None:
        return recorded_extent(path, self.bench)


def _frame_rates(
    files: Iterable[Mapping[str, Path]], own_files: bool, file_rate: float | None
) -> tuple[list[float], set[Path], list[SkippedFile]]:
    """Return the frame rates that occur, the files that state one, and those that do not."""
    rates: set[float] = set()
    usable: set[Path] = set()
    skipped = []
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
            skipped.append(SkippedFile.because(error))
    return sorted(rates), usable, skipped


def _segments(clips: Mapping[str, Mapping[str, Path]]) -> list[str]:
    return sorted({segment for paths in clips.values() for segment in paths})


def _segment(
    name: str,
    clips: Mapping[str, Mapping[str, Path]],
    recordings: Mapping[str, Path],
    speech: Mapping[str, Excerpt],
    semantics: Mapping[str, Path],
    usable: Collection[Path],
) -> SegmentFiles:
    recorded = recordings.get(name)
    return SegmentFiles(
        segment=name,
        clips={
            condition: paths[name]
            for condition, paths in clips.items()
            if name in paths and paths[name] in usable
        },
        recorded=recorded if recorded in usable else None,
        speech=speech.get(name),
        semantics=semantics.get(name),
    )


def _remarks(found: Sequence[SegmentFiles], preset: Preset, with_recordings: bool) -> Iterator[str]:
    """Yield which segments lack what a metric needs."""
    mute = [files.segment for files in found if files.speech is None]
    if preset.beats and mute:
        yield f"no beat alignment without speech: {_some(mute, len(found))}"
    alone = [files.segment for files in found if files.recorded is None]
    if with_recordings and alone:
        yield f"no comparison without a recording: {_some(alone, len(found))}"
    elif alone:
        yield "no recordings are given, so nothing is compared with them"


def _some(segments: Sequence[str], count: int) -> str:
    """Return how many segments are meant, and the first of them by name."""
    named = ", ".join(segments[:3]) + (", …" if len(segments) > 3 else "")
    return f"{len(segments)} of {count} segments ({named})"


def _by_condition(
    conditions: Iterable[str], scores: Sequence[ClipScore], seen: Sequence[FeatureScores]
) -> Iterator[ClipScore]:
    """Yield the scores of all clips by condition; by segment as far as they were measured so."""
    grouped: dict[str, list[ClipScore]] = {condition: [] for condition in conditions}
    for score in (*scores, *(score for one in seen for score in one.clips)):
        grouped[score.condition].append(score)
    for found in grouped.values():
        yield from found


def _condition_scores(
    conditions: Sequence[str],
    scores: Sequence[ClipScore],
    measured: Sequence[SegmentScores],
    bench: Bench,
    given: Sequence[Network],
    seen: Sequence[FeatureScores],
    recordings: Collection[str],
) -> Iterator[ConditionScore]:
    missing = [name for name in bench.preset.networks if name not in _kinds(given)]
    for condition in conditions:
        own = [score for score in scores if score.condition == condition]
        clips = sum(condition in one.readable for one in measured)
        yield from clip_means(condition, own)
        yield from distances_between_clips(condition, measured, bench)
        if condition not in recordings:
            yield from distances_of_speeds(condition, measured, bench)
        for one in seen:
            yield from (score for score in one.conditions if score.condition == condition)
        for name in missing:
            yield from scores_without_network(
                name, command_for(name), condition, clips, recorded=condition in recordings
            )


def _kinds(given: Sequence[Network]) -> set[str]:
    return {network.name.partition(", ")[0] for network in given}
