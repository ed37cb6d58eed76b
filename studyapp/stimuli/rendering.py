"""Rendering a study: one video per clip, and the pairs that participants see."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from motion.audio import read_audio
from motion.errors import InputError
from motion.segment import Segment
from renderer.encoder import SOUND_RATE, pad_to_equal_size
from renderer.jobs.job import Job, Outcome, PairJob
from renderer.jobs.making import run_jobs
from renderer.loudness import at_common_loudness
from renderer.pair import FrameCache
from studyapp.stimuli.disk_space import check_room, frames_limit
from studyapp.stimuli.render_plan import RenderPlan, sides_of
from studyapp.stimuli.render_record import RenderCount, RenderProgress, RenderRecord
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.folder import StudyFolder, lock_folder
from studyapp.study.media import ClipVideo, Media, PairVideo, read_stimuli


def render(
    folder: StudyFolder,
    *,
    processes: int,
    cluster: str | None = None,
    on_progress: Callable[[RenderProgress], None] = lambda progress: None,
) -> RenderCount:
    """Render each clip and pair that is missing or no longer fits what it shows.

    What is finished is recorded, so that an interrupted run goes on where it was. A video that
    cannot be made is reported and the rest goes on. Each segment's pairs follow its clips, so
    that the frames between them need not be kept longer than that. Finished videos that were
    brought, and clips to be shown without sound, are copied for the participants.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    processes : int
        How many videos are made at once.
    cluster : str or None
        Address of a Dask scheduler whose workers make them instead.
    on_progress : callable
        Called at the beginning, and after each video.

    Raises
    ------
    InputError
        If motion is missing, the disk is too small, the cluster cannot be used, or the study is
        being rendered already.
    """
    # Absolute, because workers of a cluster stand elsewhere.
    folder = StudyFolder(folder.root.absolute())
    plan = None if folder.study().only_finished else RenderPlan.of(folder)
    with _alone(folder):
        _remove_drafts(folder.videos)
        rendered = RenderCount(made=0, kept=0)
        if plan is not None:
            rendered = _render(plan, processes, cluster, on_progress)
        copied = copy_videos(folder)
        hide_sizes(folder)
    return replace(
        rendered,
        made=rendered.made + copied.made,
        kept=rendered.kept + copied.kept,
        failures=(*rendered.failures, *copied.failures),
    )


def _render(
    plan: RenderPlan,
    processes: int,
    cluster: str | None,
    on_progress: Callable[[RenderProgress], None],
) -> RenderCount:
    """Render what `plan` lacks; nobody else renders the study."""
    folder = plan.folder
    clips, pairs = _to_do(plan)
    frames = FrameCache(plan.frames_folder, 0)
    frames.keep_only({plan.frames(*side) for side in plan.sides})
    kept = frames.size()
    limit = frames_limit(folder.videos, kept)
    check_room(folder.root, [*clips, *pairs], plan.look, sides=plan.sides, limit=limit, kept=kept)
    spoken = {clip.speech or clip.segment for clip in clips}
    notes = loudness_notes(folder, [plan.segments[name] for name in sorted(spoken)])
    jobs = _jobs_in_order(plan, clips, pairs)
    room = _FrameRoom(FrameCache(plan.frames_folder, limit), jobs)
    try:
        with RenderRecord(plan, [*clips, *pairs]) as record:

            def on_done(outcome: Outcome) -> None:
                room.free(outcome)
                record.add(outcome)
                on_progress(record.progress())

            on_progress(record.progress())
            run_jobs(jobs, processes=processes, cluster=cluster, on_done=on_done)
    finally:
        _remove_drafts(folder.videos)
    return record.count(notes=(*plan.notes, *notes))


def _to_do(plan: RenderPlan) -> tuple[list[ClipVideo], list[PairVideo]]:
    """Return the pairs to be made, and the clips whose video or frames are lacking for it."""
    current = _current_files(plan.folder)
    pairs = [pair for pair in plan.pairs if current.get(pair.file) != pair.key]
    sides = sides_of(pairs)
    clips = [
        clip
        for clip in plan.clips
        if current.get(clip.file) != clip.key
        or (
            clip.speech is None
            and (clip.segment, clip.condition) in sides
            and not plan.frames(clip.segment, clip.condition).exists()
        )
    ]
    return clips, pairs


def _jobs_in_order(
    plan: RenderPlan, clips: Iterable[ClipVideo], pairs: Iterable[PairVideo]
) -> list[Job]:
    """Return the work, each segment's pairs right after its clips."""
    by_segment: defaultdict[str, list[Job]] = defaultdict(list)
    for clip in clips:
        by_segment[clip.segment].append(plan.clip_job(clip))
    for pair in pairs:
        by_segment[pair.segment].append(plan.pair_job(pair))
    return [job for segment in plan.segments for job in by_segment[segment]]


class _FrameRoom:
    """Lets frames go once no pair of this run needs them and the cache is full."""

    def __init__(self, cache: FrameCache, jobs: Sequence[Job]) -> None:
        self._cache = cache
        self._pairs = {job.name: job for job in jobs if isinstance(job, PairJob)}
        self._needed = Counter(
            side for pair in self._pairs.values() for side in (pair.left, pair.right)
        )
        self._cache.shrink(required=self._needed.keys())

    def free(self, outcome: Outcome) -> None:
        """Count a job as ended, and shrink the cache."""
        pair = self._pairs.get(outcome.name)
        for side in (pair.left, pair.right) if pair is not None else ():
            self._cache.mark_used(side)
            self._needed[side] -= 1
            if not self._needed[side]:
                del self._needed[side]
        self._cache.shrink(required=self._needed.keys())


def _current_files(folder: StudyFolder) -> dict[str, str]:
    """Return the key of each video that is recorded and really there."""
    if not folder.stimuli.exists():
        return {}
    stimuli = read_stimuli(folder.stimuli)
    return {
        record.file: record.key
        for record in (*stimuli.clips, *stimuli.pairs)
        if (folder.root / record.file).exists()
    }


def hide_sizes(folder: StudyFolder) -> None:
    """Give all videos of one segment that participants are shown the same file size.

    Of finished videos that were brought, the copies are meant.
    """
    study = folder.study()
    media = Media.of(folder, study)
    by_segment: defaultdict[str, list[Path]] = defaultdict(list)
    for content in study.contents(tuple(folder.segments_of(study))):
        found = media.find(content)
        if found is not None and found.file.exists():
            by_segment[content[0].segment].append(found.file)
    for videos in by_segment.values():
        pad_to_equal_size(list(dict.fromkeys(videos)))


def _remove_drafts(videos: Path) -> None:
    """Remove what processes that were killed left half written."""
    for draft in videos.rglob(".*"):
        if draft.suffix in {".mp4", ".mkv"}:
            draft.unlink(missing_ok=True)


@contextmanager
def _alone(folder: StudyFolder) -> Iterator[None]:
    """Keep others from rendering the study meanwhile."""
    busy = InputError(
        "this study is being rendered already",
        where=folder.root,
        remedy="Wait until the other 'motionjury render' is done, or stop it",
    )
    folder.videos.mkdir(exist_ok=True)
    with lock_folder(folder.videos, busy=busy):
        yield


def loudness_notes(folder: StudyFolder, segments: Iterable[Segment]) -> tuple[str, ...]:
    """Return a sentence for each segment whose speech cannot be made as loud as the others'.

    Nothing is said of speech that cannot be read: making its videos fails, and says why.
    """
    of_recording: defaultdict[str, list[Segment]] = defaultdict(list)
    for segment in segments:
        of_recording[segment.wav].append(segment)
    notes: list[str] = []
    for wav, spoken in of_recording.items():
        try:
            recording = read_audio(folder.speech / wav, sample_rate=SOUND_RATE)
            excerpts = [recording.cut(segment.start, segment.end) for segment in spoken]
        except InputError:
            continue
        for segment, speech in zip(spoken, excerpts, strict=True):
            new = at_common_loudness(speech).notes[len(speech.notes) :]
            notes.extend(f"the speech of segment {segment.name}: {note}" for note in new)
    return tuple(notes)
