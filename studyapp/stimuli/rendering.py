"""Rendering a study: a video per clip, and the pairs that participants see."""

from __future__ import annotations

import shutil
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.encoder import pad_to_equal_size
from renderer.jobs.making import run_jobs
from renderer.pair import FrameCache
from renderer.video_jobs import Job, Outcome, PairJob
from studyapp.stimuli.render_plan import RenderPlan, sides_of
from studyapp.stimuli.render_record import RenderCount, RenderRecord
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.folder import StudyFolder, lock_folder, require_space
from studyapp.study.media import ClipVideo, Media, PairVideo, recorded_stimuli

MAX_FRAME_BYTES: Final = 20 * 10**9
"""Bytes of cached frames, unless half of the free disk space is less."""

# Bytes per frame and pixel of one clip: twice those of a gesturing upper body.
_FRAME_CACHE: Final = 0.07
_CLIP: Final = 0.02
_PAIR: Final = 0.03
_SOUND: Final = 20_000
"""Bytes per second of sound and container."""


OnProgress = Callable[[int, int, str], None]


def render(
    folder: StudyFolder,
    *,
    processes: int,
    cluster: str | None = None,
    on_progress: OnProgress = lambda frames, all_frames, videos: None,
) -> RenderCount:
    """Render all clips and pairs that are missing or out of date.

    Finished videos are recorded, so that an interrupted run can be continued. A video that cannot
    be made is reported and the others are made. Each segment's pairs follow its clips, so that
    frames are cached no longer than needed. Videos supplied by the researcher, and clips to be
    shown without sound, are copied for participants.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    processes : int
        Number of videos made at once.
    cluster : str or None
        Address of a Dask scheduler whose workers make them instead.
    on_progress : callable
        Called at the start and after each video with (finished frames, all frames, the videos in
        words).

    Raises
    ------
    InputError
        If motion is missing, the disk is too small, the cluster cannot be used, or the study is
        already being rendered.
    """
    # Absolute, because workers of a cluster have another working directory.
    folder = StudyFolder(folder.root.absolute())
    plan = None if folder.study().only_finished else RenderPlan.of(folder)
    busy = InputError(
        "this study is already being rendered",
        where=folder.root,
        remedy="Wait until the other 'motionjury render' ends, or stop it",
    )
    folder.videos.mkdir(exist_ok=True)
    with lock_folder(folder.videos, busy=busy):
        _remove_drafts(folder.videos)
        count = RenderCount(made=0, kept=0)
        if plan is not None:
            count = _render(plan, processes, cluster, on_progress)
        copies = copy_videos(folder)
        equalise_sizes(folder)
    return replace(
        count,
        made=count.made + copies.made,
        kept=count.kept + copies.kept,
        failures=(*count.failures, *copies.failures),
    )


def _render(
    plan: RenderPlan,
    processes: int,
    cluster: str | None,
    on_progress: OnProgress,
) -> RenderCount:
    """Render the videos of `plan` that are missing; the study must be locked."""
    folder = plan.folder
    clips, pairs = _outdated_videos(plan)
    frames = FrameCache(plan.frames_folder, 0)
    frames.keep_only({plan.frames(*side) for side in plan.sides})
    kept = frames.size()
    limit = min(MAX_FRAME_BYTES, (shutil.disk_usage(folder.videos).free + kept) // 2)
    require_space(
        folder.root,
        _expected_bytes(plan, clips, pairs, room_for_frames=max(0, limit - kept)),
        work="rendering",
        remedy="Free up space, or make smaller videos (video.size in study.toml)",
    )
    jobs = _jobs_in_order(plan, clips, pairs)
    cache = _NeededFrames(FrameCache(plan.frames_folder, limit), jobs)
    try:
        with RenderRecord(plan, [*clips, *pairs]) as record:

            def on_done(outcome: Outcome) -> None:
                cache.release(outcome)
                record.add(outcome)
                on_progress(*record.progress())

            on_progress(*record.progress())
            run_jobs(jobs, processes=processes, cluster=cluster, on_done=on_done)
    finally:
        _remove_drafts(folder.videos)
    return record.count()


def _outdated_videos(plan: RenderPlan) -> tuple[list[ClipVideo], list[PairVideo]]:
    """Return outdated clips and pairs, and clips whose cached frames these pairs need."""
    stimuli = recorded_stimuli(plan.folder.stimuli)
    keys = {
        record.file: record.key
        for record in (*stimuli.clips, *stimuli.pairs)
        if (plan.folder.root / record.file).exists()
    }
    pairs = [pair for pair in plan.pairs if keys.get(pair.file) != pair.key]
    sides = sides_of(pairs)
    clips = [
        clip
        for clip in plan.clips
        if keys.get(clip.file) != clip.key
        or (
            clip.speech is None
            and (clip.segment, clip.condition) in sides
            and not plan.frames(clip.segment, clip.condition).exists()
        )
    ]
    return clips, pairs


def _expected_bytes(
    plan: RenderPlan,
    clips: Sequence[ClipVideo],
    pairs: Sequence[PairVideo],
    *,
    room_for_frames: int,
) -> float:
    """Return the bytes that videos and frames may take more than the files they replace."""
    pixels = plan.look.size**2 * plan.look.frame_rate
    video_bytes = sum(
        seconds * (pixels * each + _SOUND)
        for each, videos in ((_CLIP, clips), (_PAIR, pairs))
        for seconds in (video.duration for video in videos)
    )
    replaced = (plan.folder.root / video.file for video in (*clips, *pairs))
    video_bytes -= sum(file.stat().st_size for file in replaced if file.is_file())
    frame_bytes = sum(
        clip.duration * pixels * _FRAME_CACHE for clip in clips if plan.needed_frames(clip)
    )
    return max(0.0, video_bytes) + min(frame_bytes, room_for_frames)


def _jobs_in_order(
    plan: RenderPlan, clips: Iterable[ClipVideo], pairs: Iterable[PairVideo]
) -> list[Job]:
    """Return the jobs, with each segment's pairs right after its clips."""
    by_segment: defaultdict[str, list[Job]] = defaultdict(list)
    for clip in clips:
        by_segment[clip.segment].append(plan.clip_job(clip))
    for pair in pairs:
        by_segment[pair.segment].append(plan.pair_job(pair))
    return [job for segment in plan.segments for job in by_segment[segment]]


class _NeededFrames:
    """Keeps frames that pairs of this run still need, and lets the cache drop others."""

    def __init__(self, cache: FrameCache, jobs: Sequence[Job]) -> None:
        self._cache = cache
        self._pairs = {job.name: job for job in jobs if isinstance(job, PairJob)}
        self._needed = Counter(
            side for pair in self._pairs.values() for side in (pair.left, pair.right)
        )
        self._cache.shrink(required=self._needed.keys())

    def release(self, outcome: Outcome) -> None:
        """Release the frames of a finished job."""
        pair = self._pairs.get(outcome.name)
        for side in (pair.left, pair.right) if pair is not None else ():
            self._cache.mark_used(side)
            self._needed[side] -= 1
            if not self._needed[side]:
                del self._needed[side]
        self._cache.shrink(required=self._needed.keys())


def equalise_sizes(folder: StudyFolder) -> None:
    """Pad the videos of each segment that participants see to the same file size."""
    study = folder.study()
    media = Media.of(folder, study)
    by_segment: defaultdict[str, list[Path]] = defaultdict(list)
    for content in study.contents(folder.segments_of(study)):
        video = media.find(content)
        if video is not None and video.file.exists():
            by_segment[content[0].segment].append(video.file)
    for videos in by_segment.values():
        pad_to_equal_size(list(dict.fromkeys(videos)))


def _remove_drafts(videos: Path) -> None:
    """Remove unfinished files of processes that were killed."""
    for draft in videos.rglob(".*"):
        if draft.suffix in {".mp4", ".mkv"}:
            draft.unlink(missing_ok=True)
