"""Measuring all clips of all conditions, over what participants saw or a folder holds."""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Self, TypeVar

from threadpoolctl import threadpool_limits

from analysis.evaluators.feature_networks import Source, networks
from analysis.measurement.conditions import condition_scores, network_scores, recorded_conditions
from analysis.measurement.kept_arrays import forget_unused
from analysis.measurement.measured_clips import (
    Excerpt,
    LandmarkBody,
    SeenMotion,
    Setup,
    file_sha256,
    penetrable_body,
)
from analysis.measurement.presets import REPORT, Preset, combined
from analysis.measurement.recorded_spread import recorded_spread
from analysis.measurement.scores import ClipScore, SkippedFile, StudyMetrics
from analysis.measurement.segment_scores import (
    SegmentFiles,
    SegmentScores,
    recorded_extent,
    segment_scores,
)
from analysis.metrics.joint_motion import common_frame_rate
from analysis.metrics.self_penetration import self_penetration
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
    kept: Path | None = None,
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
        Which gestures of the recordings carry meaning (`motion.formats.beat_tracks`).
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
    kept : Path, optional
        Where joint positions, features and the like are kept between runs; what is kept under the
        settings of this run, but not used by it, is removed.
    processes : int
        How many segments are measured at once.
    on_progress : callable, optional
        Called with steps done and all steps: a step is a segment, or a recording that is looked at
        beforehand.

    Raises
    ------
    InputError
        If a preset is unknown, a network cannot be used, or if a file cannot be used and is not
        to be skipped.
    """
    preset = combined(presets)
    given = networks(evaluators)
    if penetrable is not None:
        penetrable_body(penetrable)
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
    setup = Setup(
        frame_rate=common_frame_rate(rates),
        motion=SeenMotion(frozen=tuple(frozen), own_files=own_files, file_rate=file_rate),
        preset=preset,
        kept=kept,
        face=face,
    )
    recorded_files = sorted({files.recorded for files in found if files.recorded is not None})
    looked_at = recorded_files if preset.needs_recorded_spread else []
    with Workers(processes, len(looked_at) + len(found), on_progress) as workers:
        extents = workers.each(partial(recorded_extent, setup=setup), looked_at)
        setup = replace(
            setup,
            spread=recorded_spread(extent for extent in extents if extent is not None),
            networks=given,
            penetrable=penetrable,
        )
        measured = workers.each(partial(segment_scores, setup=setup), found)
    skipped += list(dict.fromkeys(file for one in measured for file in one.skipped))
    if not skip_unusable and skipped:
        raise skipped[0].error()
    forget_unused(frozenset[Path]().union(*(one.kept for one in measured)))
    own = recorded_conditions(clips, found)
    seen = [network_scores(network, clips, measured, own, emotions or {}) for network in given]
    scores = list(_clip_scores(measured, penetrable))
    all_scores = [*scores, *(score for one in seen for score in one.clips)]
    return StudyMetrics(
        frame_rate=setup.frame_rate,
        clips=tuple(
            score for condition in clips for score in all_scores if score.condition == condition
        ),
        conditions=tuple(condition_scores(tuple(clips), scores, measured, setup, seen, own)),
        skipped=tuple(skipped),
        remarks=tuple(_remarks(found, preset, bool(recordings))),
        confusions=tuple(confusion for one in seen for confusion in one.confusions),
    )


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


def _clip_scores(measured: Sequence[SegmentScores], penetrable: Path | None) -> Iterator[ClipScore]:
    """Yield the scores of all clips, then their self-penetration."""
    clips = [
        (condition, one.segment, clip) for one in measured for condition, clip in one.clips.items()
    ]
    for condition, segment, clip in clips:
        for result in clip.scores:
            yield ClipScore(condition=condition, segment=segment, result=result)
    if penetrable is not None:
        body = f"{penetrable.stem}, file {file_sha256(penetrable)[:16]}"
        for condition, segment, clip in clips:
            if clip.depths is not None and len(clip.depths):
                for result in self_penetration(clip.depths, body=body):
                    yield ClipScore(condition=condition, segment=segment, result=result)


Show = Callable[[int, int], None]
"""Told how many tasks are done, of how many."""

_Task = TypeVar("_Task")
_Found = TypeVar("_Found")


class Workers:
    """Does tasks in this process, or in several; results come in the order of the tasks.

    Parameters
    ----------
    processes : int
        How many.
    steps : int
        All tasks that will be given.
    on_progress : callable, optional
        Told how many of them are done.
    """

    def __init__(self, processes: int, steps: int, on_progress: Show | None) -> None:
        self._pool = None
        if processes > 1:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(
                processes, mp_context=context, initializer=_one_thread_each
            )
        self._done, self._steps = 0, steps
        self._on_progress = on_progress

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def each(self, do: Callable[[_Task], _Found], tasks: Iterable[_Task]) -> list[_Found]:
        """Return what `do` finds out about each of `tasks`."""
        results = []
        for found in map(do, tasks) if self._pool is None else self._pool.map(do, tasks):
            results.append(found)
            self._done += 1
            if self._on_progress is not None:
                self._on_progress(self._done, self._steps)
        return results


def _one_thread_each() -> None:
    """Leave each process one thread for matrix products: together they have all processors."""
    threadpool_limits(1)
