"""The record of rendered videos in `stimuli.json`, kept up to date during rendering."""

import time
from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

from renderer.video_jobs import Outcome
from studyapp.stimuli.render_plan import RenderPlan
from studyapp.study.media import ClipVideo, PairVideo, Stimuli, recorded_stimuli, write_stimuli

_WRITE_SECONDS: Final = 1.0
"""Between two writes; with thousands of videos, each write takes a while."""


@dataclass(frozen=True, kw_only=True)
class RenderCount:
    """The result of a run.

    Attributes
    ----------
    made, kept : int
        Videos made by this run, copies included, and existing ones that are up to date.
    failures : tuple of str
        Videos that could not be made, and why.
    left_out : int
        Videos that could not be made because a clip failed.
    notes : tuple of str
        Motion that is not shown.
    """

    made: int
    kept: int
    failures: tuple[str, ...] = ()
    left_out: int = 0
    notes: tuple[str, ...] = ()


class RenderRecord:
    """The finished videos, which are written at the start and now and then.

    Parameters
    ----------
    plan : RenderPlan
        All videos of the study.
    pending : collection of ClipVideo and PairVideo
        Videos that this run makes; all others count as finished.
    """

    def __init__(self, plan: RenderPlan, pending: Collection[ClipVideo | PairVideo]) -> None:
        self._plan = plan
        self._pending = {video.file: video for video in pending}
        videos = (*plan.clips, *plan.pairs)
        self._finished = {video.file for video in videos if video.file not in self._pending}
        self._kept = len(self._finished)
        self._copies = recorded_stimuli(plan.folder.stimuli).copies
        self._failures: list[str] = []
        self._left_out = 0
        self._all_frames = sum(map(self._frame_count, pending))
        self._frames = 0
        self.write()

    def add(self, outcome: Outcome) -> None:
        """Record the outcome of one video."""
        self._frames += self._frame_count(self._pending[outcome.name])
        if outcome.error is None:
            self._finished.add(outcome.name)
            if time.monotonic() - self._written > _WRITE_SECONDS:
                self.write()
        elif outcome.because_of is None:
            self._failures.append(f"{outcome.name}: {outcome.error}")
        else:
            self._left_out += 1

    def progress(self) -> tuple[int, int, str]:
        """Return the frames that are drawn or given up, all frames, and the videos in words."""
        failed = len(self._failures) + self._left_out
        ended = len(self._finished) - self._kept + failed
        more = f", {failed} failed" if failed else ""
        return self._frames, self._all_frames, f"{ended} of {len(self._pending)} videos{more}"

    def count(self) -> RenderCount:
        """Return the result of the run."""
        return RenderCount(
            made=len(self._finished) - self._kept,
            kept=self._kept,
            failures=tuple(self._failures),
            left_out=self._left_out,
            notes=self._plan.notes,
        )

    def _frame_count(self, video: ClipVideo | PairVideo) -> int:
        return round(video.duration * self._plan.look.frame_rate)

    def write(self) -> None:
        """Write the record."""
        write_stimuli(
            self._plan.folder.stimuli,
            Stimuli(
                clips=tuple(clip for clip in self._plan.clips if clip.file in self._finished),
                pairs=tuple(pair for pair in self._plan.pairs if pair.file in self._finished),
                copies=self._copies,
            ),
        )
        self._written = time.monotonic()
