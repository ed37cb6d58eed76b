"""Answered trials: counts by emotion and arm, and durations."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median, quantiles
from typing import Final, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.table import ANALYSED_KINDS
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial

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
