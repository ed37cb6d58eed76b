"""Rendering a study: a video per clip, and the pairs that participants see."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.encoder import pad_to_equal_size
from renderer.jobs.making import run_jobs
from renderer.video_jobs import Job, Outcome, PairJob
from studyapp.stimuli.render_plan import RenderPlan, sides_of
from studyapp.stimuli.render_record import RenderCount, RenderRecord
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.folder import StudyFolder, lock_folder, require_space
from studyapp.study.media import ClipVideo, Media, PairVideo, recorded_stimuli

# Bytes per frame and pixel of one clip: twice those of a gesturing upper body.
_FRAMES: Final = 0.07
_VIDEO: Final = 0.03
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
    be made is reported and the others are made. Each segment's pairs follow its clips, so that few
    lossless frames are kept at once. Videos supplied by the researcher, and clips to be
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
    jobs = _jobs_in_order(plan, clips, pairs)
    frames = _NeededFrames(plan.frames_folder, jobs)
    require_space(
        folder.root,
        _expected_bytes(plan, clips, pairs, segments_at_once=processes + 1),
        work="rendering",
        remedy="Free up space, or make smaller videos (video.size in study.toml)",
    )
    record = RenderRecord(plan, [*clips, *pairs])

    def on_done(outcome: Outcome) -> None:
        frames.release(outcome)
        record.add(outcome)
        on_progress(*record.progress())

    try:
        on_progress(*record.progress())
        run_jobs(jobs, processes=processes, cluster=cluster, on_done=on_done)
    finally:
        record.write()
        frames.remove_unneeded()
        _remove_drafts(folder.videos)
    return record.count()


def _outdated_videos(plan: RenderPlan) -> tuple[list[ClipVideo], list[PairVideo]]:
    """Return outdated clips and pairs, and clips of which these pairs need frames."""
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
    segments_at_once: int,
) -> float:
    """Return the bytes that new videos and frames may take."""
    pixels = plan.look.size**2 * plan.look.frame_rate
    video_bytes = sum(video.duration * (pixels * _VIDEO + _SOUND) for video in (*clips, *pairs))
    frame_bytes: Counter[str] = Counter()
    for clip in clips:
        if plan.needed_frames(clip):
            frame_bytes[clip.segment] += round(clip.duration * pixels * _FRAMES)
    largest = frame_bytes.most_common(segments_at_once)
    return video_bytes + sum(size for _, size in largest)


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
    """The lossless frames in a folder, which are removed when no pair of this run needs them."""

    def __init__(self, folder: Path, jobs: Sequence[Job]) -> None:
        self._folder = folder
        self._pairs = {job.name: job for job in jobs if isinstance(job, PairJob)}
        self._needed = Counter(
            side for pair in self._pairs.values() for side in (pair.left, pair.right)
        )
        self.remove_unneeded()

    def release(self, outcome: Outcome) -> None:
        """Remove the frames that only a finished job still needed."""
        pair = self._pairs.get(outcome.name)
        for side in (pair.left, pair.right) if pair is not None else ():
            self._needed[side] -= 1
            if not self._needed[side]:
                side.unlink(missing_ok=True)

    def remove_unneeded(self) -> None:
        """Remove all other frames, as of an earlier run."""
        for frames in self._folder.glob("*.mkv"):
            if not self._needed[frames]:
                frames.unlink()


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
