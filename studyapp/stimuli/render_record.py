"""What of a study's videos is made: `stimuli.json`, kept true while rendering goes on."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import dataclass
from types import TracebackType
from typing import Final, Self

from renderer.jobs.job import Outcome
from studyapp.stimuli.render_plan import RenderPlan
from studyapp.study.media import ClipVideo, PairVideo, Stimuli, read_stimuli, write_stimuli

_WRITTEN_EVERY: Final = 1.0
"""Seconds between two writings; of thousands of videos, each takes its time."""


@dataclass(frozen=True, kw_only=True)
class RenderProgress:
    """How far a run is.

    Attributes
    ----------
    videos, frames : int
        Dealt with, whether made or failed.
    all_videos, all_frames : int
        To be dealt with.
    kept : int
        Videos that were there and still fit.
    failed : int
        Videos that could not be made.
    """

    videos: int
    all_videos: int
    frames: int
    all_frames: int
    kept: int
    failed: int


@dataclass(frozen=True, kw_only=True)
class RenderCount:
    """What a run did, and what is to be said of it.

    Attributes
    ----------
    made, kept : int
        Videos made by this run, copies included, and those that were there and still fit.
    failures : tuple of str
        Videos that could not be made, and why.
    left_out : int
        Videos that could not be made because a clip that they are made from could not.
    notes : tuple of str
        What the videos do not show or sound as others do.
    """

    made: int
    kept: int
    failures: tuple[str, ...] = ()
    left_out: int = 0
    notes: tuple[str, ...] = ()


class RenderRecord:
    """The videos that are finished; leaving the ``with`` block writes them down.

    Parameters
    ----------
    plan : RenderPlan
        All videos of the study.
    to_do : collection of ClipVideo and PairVideo
        Those that this run makes; all others count as finished.
    """

    def __init__(self, plan: RenderPlan, to_do: Collection[ClipVideo | PairVideo]) -> None:
        self._plan = plan
        self._to_do = {record.file: record for record in to_do}
        everything = (*plan.clips, *plan.pairs)
        self._finished = {record.file for record in everything if record.file not in self._to_do}
        self._kept = len(self._finished)
        known = plan.folder.stimuli
        self._copies = read_stimuli(known).copies if known.exists() else ()
        self._failures: list[str] = []
        self._left_out = 0
        self._all_frames = sum(self._frame_count(record) for record in to_do)
        self._frames = 0
        self._written = 0.0

    def __enter__(self) -> Self:
        self._write()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._write()

    def add(self, outcome: Outcome) -> None:
        """Record what became of one video."""
        self._frames += self._frame_count(self._to_do[outcome.name])
        if outcome.error is None:
            self._finished.add(outcome.name)
            if time.monotonic() - self._written > _WRITTEN_EVERY:
                self._write()
        elif outcome.because_of is None:
            self._failures.append(f"{outcome.name}: {outcome.error}")
        else:
            self._left_out += 1

    def progress(self) -> RenderProgress:
        """Return how far the run is."""
        made = len(self._finished) - self._kept
        failed = len(self._failures) + self._left_out
        return RenderProgress(
            videos=made + failed,
            all_videos=len(self._to_do),
            frames=self._frames,
            all_frames=self._all_frames,
            kept=self._kept,
            failed=failed,
        )

    def count(self, notes: tuple[str, ...]) -> RenderCount:
        """Return what the run did."""
        return RenderCount(
            made=len(self._finished) - self._kept,
            kept=self._kept,
            failures=tuple(self._failures),
            left_out=self._left_out,
            notes=notes,
        )

    def _frame_count(self, record: ClipVideo | PairVideo) -> int:
        return round(record.duration * self._plan.look.frame_rate)

    def _write(self) -> None:
        write_stimuli(
            self._plan.folder.stimuli,
            Stimuli(
                clips=tuple(clip for clip in self._plan.clips if clip.file in self._finished),
                pairs=tuple(pair for pair in self._plan.pairs if pair.file in self._finished),
                copies=self._copies,
            ),
        )
        self._written = time.monotonic()
