"""Rendering a study: one video per clip, and the pairs that participants see."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from renderer.job import Outcome
from renderer.jobs import run_jobs
from renderer.mp4_padding import pad_to_equal_size
from studyapp.definition.folder import StudyFolder
from studyapp.definition.media import Media
from studyapp.definition.stimuli import (
    ClipVideo,
    PairVideo,
    Stimuli,
    read_stimuli,
    write_stimuli,
)
from studyapp.stages.render_plan import RenderPlan


@dataclass(frozen=True)
class RenderCount:
    """How many videos a run made, how many were there already, and what is to be said.

    Attributes
    ----------
    failures : tuple of str
        Videos that could not be made, and why.
    notes : tuple of str
        What of the motion the videos do not show.
    """

    made: int
    kept: int
    failures: tuple[str, ...]
    notes: tuple[str, ...] = ()


def render(
    folder: StudyFolder,
    *,
    processes: int,
    on_done: Callable[[int, int], None] = lambda done, total: None,
) -> RenderCount:
    """Render each clip and pair that is missing or no longer fits what it shows.

    Finished videos that were brought are only given equal sizes.

    What is finished is recorded at once, so that an interrupted run goes on where it was. A
    video that cannot be made is reported and the rest goes on.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    processes : int
        How many videos are made at once.
    on_done : callable
        Called with (videos done, videos to do) after each.
    """
    if folder.study().only_finished:
        hide_sizes(folder)
        return RenderCount(made=0, kept=0, failures=())
    plan = RenderPlan.of(folder)
    current = _current_files(folder)
    pairs = [pair for pair in plan.pairs if current.get(pair.file) != pair.key]
    sides = {(pair.segment, side) for pair in pairs for side in (pair.left, pair.right)}
    clips = [
        clip
        for clip in plan.clips
        if current.get(clip.file) != clip.key
        or (
            (clip.segment, clip.condition) in sides
            and not plan.frames(clip.segment, clip.condition).exists()
        )
    ]
    log = _Log(folder, plan, to_do=[*clips, *pairs], on_done=on_done)
    run_jobs([plan.clip_job(clip) for clip in clips], processes=processes, on_done=log.add)
    run_jobs(
        [plan.pair_job(pair) for pair in pairs if plan.can_compose(pair)],
        processes=processes,
        on_done=log.add,
    )
    hide_sizes(folder)
    _remove_leftovers(folder, plan)
    return log.count()


class _Log:
    """Keeps `stimuli.json` true while videos are being made."""

    def __init__(
        self,
        folder: StudyFolder,
        plan: RenderPlan,
        *,
        to_do: list[ClipVideo | PairVideo],
        on_done: Callable[[int, int], None],
    ) -> None:
        self._path = folder.stimuli
        self._plan = plan
        self._to_do = {record.file: record for record in to_do}
        self._finished = {
            record.file: record
            for record in (*plan.clips, *plan.pairs)
            if record.file not in self._to_do
        }
        self._kept = len(self._finished)
        self._failures: list[str] = []
        self._on_done = on_done
        self._write()

    def add(self, outcome: Outcome) -> None:
        """Record what became of one video."""
        if outcome.error is None:
            self._finished[outcome.name] = self._to_do[outcome.name]
            self._write()
        else:
            self._failures.append(f"{outcome.name}: {outcome.error}")
        made = len(self._finished) - self._kept
        self._on_done(made + len(self._failures), len(self._to_do))

    def count(self) -> RenderCount:
        """Return what this run did; a pair whose clip failed counts as failed with it."""
        return RenderCount(
            made=len(self._finished) - self._kept,
            kept=self._kept,
            failures=tuple(self._failures),
            notes=self._plan.notes,
        )

    def _write(self) -> None:
        write_stimuli(
            self._path,
            Stimuli(
                clips=tuple(clip for clip in self._plan.clips if clip.file in self._finished),
                pairs=tuple(pair for pair in self._plan.pairs if pair.file in self._finished),
            ),
        )


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

    Finished videos that were brought are padded as well; what they show stays as it is.
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


def _remove_leftovers(folder: StudyFolder, plan: RenderPlan) -> None:
    """Remove frames that no clip of the plan needs any more."""
    needed = {plan.frames(clip.segment, clip.condition) for clip in plan.clips}
    for path in (folder.videos / ".frames").glob("*.mkv"):
        if path not in needed:
            path.unlink()
