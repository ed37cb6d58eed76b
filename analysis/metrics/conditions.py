"""All metrics of all conditions, over the clips that participants saw or a folder holds."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.clip_scores import pose_settings
from analysis.metrics.diversity import mean_pair_distance, motion_features
from analysis.metrics.joint_motion import JointMotionStore
from analysis.metrics.joint_positions import common_frame_rate
from analysis.metrics.presets import REPORT, Preset, combined
from analysis.metrics.recorded_spread import ClipExtent, recorded_spread
from analysis.metrics.result import Better, MetricResult
from analysis.metrics.segment_scores import (
    Bench,
    ClipScore,
    Excerpt,
    SegmentFiles,
    SegmentScores,
    SkippedFile,
    recorded_extent,
    segment_scores,
)
from analysis.metrics.workers import Show, Workers
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.clip_npz import read_frame_rate


@dataclass(frozen=True, kw_only=True)
class ConditionScore:
    """One metric of one condition.

    Attributes
    ----------
    condition, name, unit : str
        What was measured, on what.
    value : float
        Mean over the clips that have a score, or the score of the whole condition; NaN for none.
    spread : float
        Standard deviation over those clips; NaN for fewer than two and for a score of the whole
        condition.
    scored, clips : int
        Clips that have a score, and clips there are.
    settings : mapping of str to str
        As in `MetricResult`.
    reason : str
        Why clips have no score; empty where all have one.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores speak for a condition.
    """

    condition: str
    name: str
    unit: str
    value: float
    spread: float
    scored: int
    clips: int
    settings: Mapping[str, str]
    reason: str
    better: Better = "unsaid"


@dataclass(frozen=True, kw_only=True)
class StudyMetrics:
    """Everything measured: by clip, and by condition in the order the conditions were given.

    Attributes
    ----------
    frame_rate : float
        Frames per second at which clips were compared; NaN without clips.
    clips : tuple of ClipScore
        By condition, then segment.
    conditions : tuple of ConditionScore
        By condition.
    skipped : tuple of SkippedFile
        Files that could not be used.
    remarks : tuple of str
        What there was no speech or recording for, so that metrics are missing.
    """

    frame_rate: float
    clips: tuple[ClipScore, ...]
    conditions: tuple[ConditionScore, ...]
    skipped: tuple[SkippedFile, ...] = ()
    remarks: tuple[str, ...] = ()


def study_metrics(
    clips: Mapping[str, Mapping[str, Path]],
    speech: Mapping[str, Excerpt],
    *,
    frozen: Collection[str] = (),
    recorded: Mapping[str, Path] | None = None,
    semantics: Mapping[str, Path] | None = None,
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
    presets : iterable of str
        Names in `analysis.metrics.presets.PRESETS`.
    own_files : bool
        Whether the motion files are a study's own, read as they stand; files from elsewhere are of
        any format and put into the study's world.
    file_rate : float, optional
        Frames per second of all motion files, in place of what they state.
    skip_unusable : bool
        Whether files that cannot be used are left out and named, rather than an error.
    store : JointMotionStore, optional
        Where joint positions are kept between runs; what this run does not use is removed.
    processes : int
        How many segments are measured at once.
    on_progress : callable, optional
        Called with segments done and all segments.

    Raises
    ------
    InputError
        If a preset is unknown, or if a file cannot be used and is not to be skipped.
    """
    preset = combined(presets)
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
    bench = Bench(
        frame_rate=common_frame_rate(rates),
        frozen=tuple(frozen),
        preset=preset,
        store=store,
        own_files=own_files,
        file_rate=file_rate,
    )
    with Workers(processes) as workers:
        if preset.needs_recorded_spread:
            files = sorted({f.recorded for f in found if f.recorded is not None})
            extents = workers.each(_ExtentOf(bench), files, None)
            bench = replace(bench, spread=recorded_spread(e for e in extents if e is not None))
        measured = workers.each(_ScoresOf(bench), found, on_progress)
    skipped += list(dict.fromkeys(file for one in measured for file in one.skipped))
    if not skip_unusable and skipped:
        raise skipped[0].error()
    if store is not None:
        store.forget_others({place for one in measured for place in one.kept})
    collected = _collected(tuple(clips), measured, bench, tuple(skipped))
    return replace(collected, remarks=tuple(_remarks(found, preset, bool(recordings))))


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


def _collected(
    conditions: Sequence[str],
    measured: Sequence[SegmentScores],
    bench: Bench,
    skipped: tuple[SkippedFile, ...],
) -> StudyMetrics:
    by_clip: list[ClipScore] = []
    by_condition: list[ConditionScore] = []
    for condition in conditions:
        scores = [
            score
            for segment in measured
            for score in segment.scores
            if score.condition == condition
        ]
        by_clip += scores
        by_condition += _summaries(condition, scores)
        bodies = [
            segment.upper_bodies[condition]
            for segment in measured
            if condition in segment.upper_bodies
        ]
        by_condition += _pair_distance(condition, bodies, bench.frame_rate)
    return StudyMetrics(
        frame_rate=bench.frame_rate,
        clips=tuple(by_clip),
        conditions=tuple(by_condition),
        skipped=skipped,
    )


def _pair_distance(
    condition: str, clips: Sequence[NDArray[np.float32]], frame_rate: float
) -> Iterator[ConditionScore]:
    if not clips:
        return
    result = mean_pair_distance(
        motion_features([clip.astype(np.float64) for clip in clips]),
        settings=pose_settings(frame_rate)
        | {"distance": "root mean square over frames and joints, clips cut to the shortest"},
    )
    yield ConditionScore(
        condition=condition,
        name=result.name,
        unit=result.unit,
        value=result.value,
        spread=math.nan,
        scored=0 if result.reason else len(clips),
        clips=len(clips),
        settings=result.settings,
        reason=result.reason,
        better=result.better,
    )


def _summaries(condition: str, scores: Sequence[ClipScore]) -> Iterator[ConditionScore]:
    by_name: dict[str, list[MetricResult]] = {}
    for score in scores:
        by_name.setdefault(score.result.name, []).append(score.result)
    for name, results in by_name.items():
        values = np.array([result.value for result in results if not result.reason])
        reasons = [result.reason for result in results if result.reason]
        why = "; ".join(
            f"{reason} ({reasons.count(reason)} of {len(results)} clips)"
            for reason in dict.fromkeys(reasons)
        )
        yield ConditionScore(
            condition=condition,
            name=name,
            unit=results[0].unit,
            value=float(values.mean()) if len(values) else math.nan,
            spread=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
            scored=len(values),
            clips=len(results),
            settings=results[0].settings,
            reason=why,
            better=results[0].better,
        )
