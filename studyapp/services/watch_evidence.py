"""Watch evidence: what the reports of a browser prove to have been watched, judged here.

A report tells of one stretch of playing, all of it alike: as recorded or faster, in view or not,
heard or not. Only what was played no faster than recorded, in view, and heard where there is
something to hear counts as watched.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from studyapp.models import Trial

Interval = tuple[float, float]

FASTEST: Final = 1.05
"""Playback rate up to which a video counts as played as it was recorded."""


@dataclass(frozen=True, kw_only=True)
class Playback:
    """How a stretch of a video played, as a browser reports it.

    Attributes
    ----------
    rate : float
        Largest playback rate seen; 1 is as recorded.
    hidden_seconds, silent_seconds : float
        How long it played where nobody could see it, and where nobody could hear it.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data while meant to play.
    frames, dropped_frames : int or None
        Pictures to be shown and pictures left out since the page was loaded; None where the
        browser does not count them.
    """

    rate: float = 1.0
    hidden_seconds: float = 0.0
    silent_seconds: float = 0.0
    stalls: int = 0
    stalled_seconds: float = 0.0
    frames: int | None = None
    dropped_frames: int | None = None


AS_RECORDED: Final = Playback()


@dataclass(frozen=True, kw_only=True)
class Report(Playback):
    """One numbered report of how a stretch of a video played.

    Attributes
    ----------
    batch : int
        Its number within the video, from 0.
    intervals : list of [float, float]
        Played parts, each from and to, in seconds.
    """

    batch: int
    intervals: list[list[float]]


class Reported(Protocol):
    """What must be known of a report to judge it, just sent or stored alike."""

    @property
    def batch(self) -> int:
        """Its number within the video."""

    @property
    def intervals(self) -> list[list[float]]:
        """Played parts, each from and to, in seconds."""

    @property
    def rate(self) -> float:
        """Largest playback rate seen."""

    @property
    def hidden_seconds(self) -> float:
        """How long it played where nobody could see it."""

    @property
    def silent_seconds(self) -> float:
        """How long it played where nobody could hear it."""


class Played(Protocol):
    """What must be known of a video to judge the reports of it."""

    @property
    def duration(self) -> float:
        """Its length in seconds."""

    @property
    def soundless(self) -> bool:
        """Whether it is meant to be seen without sound."""

    @property
    def watch_batches(self) -> Sequence[Reported]:
        """The reports of it."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What is known of one video of a trial.

    Attributes
    ----------
    intervals : tuple of (float, float)
        Watched parts in seconds, merged and in order.
    missing : float
        Seconds that must still be watched before the questions can be answered.
    next_batch : int
        Number of the next report.
    stored : bool
        Whether the report just sent is among those known; not so where another window has used
        its number.
    """

    intervals: tuple[Interval, ...]
    missing: float
    next_batch: int
    stored: bool = True


def merged(intervals: Iterable[Interval]) -> tuple[Interval, ...]:
    """Return the union of `intervals` as disjoint ones in order."""
    union: list[Interval] = []
    for start, end in sorted(intervals):
        if union and start <= union[-1][1]:
            union[-1] = (union[-1][0], max(union[-1][1], end))
        else:
            union.append((start, end))
    return tuple(union)


def length(intervals: Iterable[Interval]) -> float:
    """Return the seconds of all `intervals` together, what is in two of them twice."""
    return sum(end - start for start, end in intervals)


def counts(batch: Reported, video: Played) -> bool:
    """Tell whether what `batch` reports of `video` as played was watched."""
    return (
        batch.rate <= FASTEST
        and batch.hidden_seconds == 0
        and (batch.silent_seconds == 0 or video.soundless)
    )


def watched_so_far(video: Played, coverage: float) -> Watched:
    """Return what has been watched of `video`.

    Parameters
    ----------
    video : Played
        With its reports.
    coverage : float
        Share of the video that must have been watched, in [0, 1].
    """
    union = merged(
        (start, end)
        for batch in video.watch_batches
        if counts(batch, video)
        for start, end in batch.intervals
    )
    missing = max(0.0, coverage * video.duration - length(union))
    return Watched(
        intervals=union,
        missing=0.0 if missing < 1e-3 else missing,
        next_batch=max((batch.batch for batch in video.watch_batches), default=-1) + 1,
    )


def missing_seconds(trial: Trial, coverage: float) -> float:
    """Return the seconds that must still be watched of all videos of `trial` together."""
    return sum(watched_so_far(video, coverage).missing for video in trial.videos)


def watched_share(trial: Trial) -> float:
    """Return the share of all videos of `trial` together that was watched, in [0, 1]."""
    played = sum(length(watched_so_far(video, 0.0).intervals) for video in trial.videos)
    return min(1.0, played / sum(video.duration for video in trial.videos))


def sum_with_restarts(totals: Sequence[int | None]) -> int | None:
    """Return how much a counter has counted in all.

    Parameters
    ----------
    totals : sequence of int or None
        What it stood at, in order. It begins again at 0 whenever the page is loaded again, which
        shows where it stands lower than before. None where it was not read.

    Returns
    -------
    int or None
        None where it was never read.
    """
    read = [total for total in totals if total is not None]
    if not read:
        return None
    ends = [now for now, after in itertools.pairwise(read) if after < now]
    return sum(ends) + read[-1]
