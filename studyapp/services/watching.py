"""Watch evidence: which parts of a video were really played, judged by the server."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.clock import Clock
from studyapp.definition.study import Study
from studyapp.models import Trial, WatchBatch
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.refusal import UnacceptableError
from studyapp.services.sitting import find, require_present, trial_of

Interval = tuple[float, float]

TOLERANCE: Final = 1.0
"""Seconds by which a browser's clock may be ahead of what has passed on the server."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What is known of a trial's video.

    Attributes
    ----------
    intervals : tuple of (float, float)
        Played parts in seconds, merged and in order.
    missing : float
        Seconds that must still be played before the questions can be answered.
    next_batch : int
        Number of the next report.
    """

    intervals: tuple[Interval, ...]
    missing: float
    next_batch: int


def merged(intervals: Iterable[Interval]) -> tuple[Interval, ...]:
    """Return the union of `intervals` as disjoint ones in order."""
    union: list[Interval] = []
    for start, end in sorted(intervals):
        if union and start <= union[-1][1]:
            union[-1] = (union[-1][0], max(union[-1][1], end))
        else:
            union.append((start, end))
    return tuple(union)


def length(intervals: Sequence[Interval]) -> float:
    """Return the seconds that disjoint `intervals` cover together."""
    return sum(end - start for start, end in intervals)


def watched_so_far(trial: Trial, coverage: float) -> Watched:
    """Return what has been played of the video of `trial`.

    Parameters
    ----------
    trial : Trial
        Loaded with its watch batches.
    coverage : float
        Share of the video that must have been played, in [0, 1].
    """
    reported = [(start, end) for batch in trial.watch_batches for start, end in batch.intervals]
    union = merged(reported)
    missing = max(0.0, coverage * trial.duration - length(union))
    return Watched(
        intervals=union,
        missing=0.0 if missing < 1e-3 else missing,
        next_batch=max((batch.batch for batch in trial.watch_batches), default=-1) + 1,
    )


def watched_share(trial: Trial) -> float:
    """Return the share of the video of `trial` that was played, in [0, 1]."""
    return min(1.0, length(watched_so_far(trial, 0.0).intervals) / trial.duration)


def record_watched(
    database: Database,
    token: str,
    media_token: str,
    *,
    batch: int,
    intervals: Sequence[Interval],
    study: Study,
    clock: Clock,
) -> Watched:
    """Store one numbered report of played intervals and return what is known now.

    A number is stored once, so that a report may be sent again when its fate is unknown. Where
    another window has used the number, the answer lacks what was reported; it can be sent again
    under `Watched.next_batch`.

    Parameters
    ----------
    batch : int
        Number of the report within the trial, from 0.
    intervals : sequence of (float, float)
        Played parts in seconds from the video's start; what lies outside the video is cut off.

    Raises
    ------
    RefusalError
        If the trial is not theirs or not the present one, or more is claimed to be played than
        time has passed since the video was first shown.
    """
    with database.writing() as session:
        study_session = find(session, token)
        trial = trial_of(study_session, media_token)
        regain_place(session, study, study_session)
        shown_at = require_present(study_session, trial)
        coverage = study.watching.coverage
        inside = [
            (max(0.0, start), min(trial.duration, end))
            for start, end in intervals
            if start < trial.duration and end > max(0.0, start)
        ]
        if batch in {known.batch for known in trial.watch_batches}:
            return watched_so_far(trial, coverage)
        passed = clock.seconds_since(shown_at)
        before = watched_so_far(trial, coverage).intervals
        if length(merged([*before, *inside])) > passed + TOLERANCE:
            raise UnacceptableError(
                "More of the video was reported as played than time has passed.",
                "Please play it again.",
            )
        now = clock.now()
        study_session.last_active_at = now
        trial.watch_batches.append(
            WatchBatch(batch=batch, intervals=[list(pair) for pair in inside], received_at=now)
        )
        session.flush()
        return watched_so_far(trial, coverage)
