"""Answered trials: counts by emotion and arm, durations, and the sides of conditions."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median, quantiles
from typing import Final, NamedTuple

from sqlalchemy import case, func, select
from sqlalchemy.orm import Session

from analysis.answers.table import ANALYSED_KINDS
from studyapp.database.tables import StudySession, Trial, TrialStimulus

MAX_DEVIATION: Final = 3.0
"""From one half, in standard errors of a fair coin; more is unlikely by chance."""

MIN_COUNT: Final = 4
"""For fewer values there are no quartiles."""


class AnsweredTrial(NamedTuple):
    """One answered trial of somebody who did not withdraw."""

    study_session: int
    kind: str
    emotion: str
    seconds: float | None


def answered_trials(session: Session) -> list[AnsweredTrial]:
    """Read every answered trial."""
    query = (
        select(Trial.study_session_id, Trial.kind, Trial.emotion, Trial.seconds)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .where(Trial.answered_at.is_not(None), StudySession.withdrawn_at.is_(None))
    )
    return [AnsweredTrial(*row) for row in session.connection().execute(query).all()]


def analysed_by_emotion(
    trials: Iterable[AnsweredTrial], arms: Mapping[int, str]
) -> dict[str, Counter[str]]:
    """Count the trials that are analysed, by emotion in alphabetical order and by arm.

    Parameters
    ----------
    arms : mapping of study session to arm
        The arms of all `trials`.
    """
    counts: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for trial in trials:
        if trial.kind in ANALYSED_KINDS:
            counts[trial.emotion][arms[trial.study_session]] += 1
    return dict(sorted(counts.items()))


@dataclass(frozen=True, kw_only=True)
class Durations:
    """How long something takes, in seconds.

    Attributes
    ----------
    what : str
    count : int
        The number of values.
    low, middle, high : float or None
        The quartiles; None if there are too few values.
    """

    what: str
    count: int
    low: float | None = None
    middle: float | None = None
    high: float | None = None

    @property
    def reason(self) -> str:
        """Why there are no quartiles; empty if there are."""
        return "" if self.middle is not None else f"fewer than {MIN_COUNT}"


def durations(what: str, seconds: Sequence[float]) -> Durations:
    """Return the quartiles of `seconds`."""
    if len(seconds) < MIN_COUNT:
        return Durations(what=what, count=len(seconds))
    low, _, high = quantiles(seconds, n=4, method="inclusive")
    return Durations(what=what, count=len(seconds), low=low, middle=median(seconds), high=high)


def trial_durations(trials: Iterable[AnsweredTrial], kinds: Sequence[str]) -> tuple[Durations, ...]:
    """Return how long trials of each kind take, from the first showing to the answer."""
    by_kind: dict[str, list[float]] = {kind: [] for kind in kinds}
    for trial in trials:
        if trial.seconds is not None and trial.kind in by_kind:
            by_kind[trial.kind].append(trial.seconds)
    return tuple(durations(kind, seconds) for kind, seconds in by_kind.items() if seconds)


@dataclass(frozen=True, kw_only=True)
class Sides:
    """How often a condition was shown on either side of a pair.

    Attributes
    ----------
    condition : str
        Its display name.
    left, right : int
        In answered trials that are analysed.
    """

    condition: str
    left: int
    right: int

    @property
    def shown(self) -> int:
        """How often it was shown."""
        return self.left + self.right

    @property
    def balanced(self) -> bool:
        """Whether chance may explain the difference."""
        spread = 0.5 * math.sqrt(self.shown)
        return abs(self.left - self.shown / 2) <= MAX_DEVIATION * spread


def sides(session: Session, names: Mapping[str, str]) -> tuple[Sides, ...]:
    """Count the sides of each condition in answered pairs; they are called as `names` says."""
    judged = (
        select(TrialStimulus.trial_id)
        .where(TrialStimulus.number > 0)
        .group_by(TrialStimulus.trial_id)
        .having(func.count() == len(("left", "right")))
    )
    query = (
        select(
            TrialStimulus.condition,
            func.sum(case((TrialStimulus.number == 1, 1), else_=0)),
            func.sum(case((TrialStimulus.number == 2, 1), else_=0)),
        )
        .join(Trial, Trial.id == TrialStimulus.trial_id)
        .where(
            Trial.answered_at.is_not(None),
            Trial.kind.in_(ANALYSED_KINDS),
            TrialStimulus.number > 0,
            TrialStimulus.trial_id.in_(judged),
        )
        .group_by(TrialStimulus.condition)
        .order_by(TrialStimulus.condition)
    )
    return tuple(
        Sides(condition=names.get(condition, condition), left=left, right=right)
        for condition, left, right in session.connection().execute(query)
    )
