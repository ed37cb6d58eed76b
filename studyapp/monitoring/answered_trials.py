"""Progress by arm and emotion, and how long trials take."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median, quantiles
from typing import Final, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import StudySession, Trial

ANALYSED: Final = ("main", "repeat")
"""Kinds of trial whose answers the analysis uses."""

FEWEST: Final = 4
"""Quartiles of fewer values say nothing."""


class AnsweredTrial(NamedTuple):
    """One answered trial of somebody who did not withdraw."""

    sitting: int
    position: int
    kind: str
    emotion: str
    seconds: float | None


def answered_trials(session: Session) -> list[AnsweredTrial]:
    """Read every answered trial."""
    query = (
        select(Trial.study_session_id, Trial.position, Trial.kind, Trial.emotion, Trial.seconds)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .where(Trial.answered_at.is_not(None), StudySession.withdrawn_at.is_(None))
    )
    return [AnsweredTrial(*row) for row in session.connection().execute(query).all()]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Answered trials that are analysed, by arm and emotion.

    Attributes
    ----------
    emotions : tuple of str
        In alphabetical order; an empty one is speech without a named emotion.
    counts : mapping of (arm, emotion) to int
        Nothing where it is 0.
    """

    emotions: tuple[str, ...]
    counts: Mapping[tuple[str, str], int]

    def of(self, arm: str, emotion: str) -> int:
        """Return the number of answered trials of one arm and emotion."""
        return self.counts.get((arm, emotion), 0)

    def of_emotion(self, emotion: str) -> int:
        """Return the number of all arms together."""
        return sum(count for (_, name), count in self.counts.items() if name == emotion)

    @property
    def largest(self) -> int:
        """The largest number of any emotion; 0 where nothing was answered."""
        return max((self.of_emotion(emotion) for emotion in self.emotions), default=0)


def progress(trials: Iterable[AnsweredTrial], arms: Mapping[int, str]) -> Progress:
    """Return the progress by arm and emotion.

    Parameters
    ----------
    arms : mapping of study session to arm
        Trials of other study sessions are not counted.
    """
    counts = Counter(
        (arms[trial.sitting], trial.emotion)
        for trial in trials
        if trial.kind in ANALYSED and trial.sitting in arms
    )
    return Progress(emotions=tuple(sorted({emotion for _, emotion in counts})), counts=counts)


@dataclass(frozen=True, kw_only=True)
class Times:
    """How long something takes, in seconds.

    Attributes
    ----------
    what : str
    count : int
        How many there are.
    low, middle, high : float or None
        The quartiles; None where there are too few.
    """

    what: str
    count: int
    low: float | None = None
    middle: float | None = None
    high: float | None = None

    @property
    def reason(self) -> str:
        """Why there are no quartiles; empty where there are."""
        return "" if self.middle is not None else f"fewer than {FEWEST}"


def times(what: str, seconds: Sequence[float]) -> Times:
    """Return median and quartiles of `seconds`."""
    if len(seconds) < FEWEST:
        return Times(what=what, count=len(seconds))
    low, _, high = quantiles(seconds, n=4, method="inclusive")
    return Times(what=what, count=len(seconds), low=low, middle=median(seconds), high=high)


def times_of_trials(trials: Iterable[AnsweredTrial], kinds: Sequence[str]) -> tuple[Times, ...]:
    """Return how long trials of each kind take, from the first showing to the answer."""
    found: dict[str, list[float]] = {kind: [] for kind in kinds}
    for trial in trials:
        if trial.seconds is not None and trial.kind in found:
            found[trial.kind].append(trial.seconds)
    return tuple(times(kind, seconds) for kind, seconds in found.items() if seconds)
