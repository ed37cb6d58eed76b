"""Counts of places, a forecast of the end, and who left where."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final

from studyapp.monitoring.study_sessions import SessionProgress
from studyapp.study.design.trial import Arm


@dataclass(frozen=True, kw_only=True)
class PlaceCounts:
    """Places of an arm, or of all arms.

    Attributes
    ----------
    arm : str
        Empty for all arms.
    wanted : int
        How many the study asks for.
    done, active, stale : int
        Taken places, by the standing of their study sessions.
    """

    arm: str
    wanted: int
    done: int
    active: int
    stale: int

    @property
    def open(self) -> int:
        """Wanted places that nobody holds; 0 if more are held than are wanted now."""
        return max(0, self.wanted - self.done - self.active - self.stale)

    @property
    def remaining(self) -> int:
        """Participants who still have to finish."""
        return max(0, self.wanted - self.done)


def count_places(
    arms: Iterable[Arm], study_sessions: Iterable[SessionProgress], more_places: int = 0
) -> tuple[PlaceCounts, ...]:
    """Return the counts of each arm, in the order of the study.

    Parameters
    ----------
    more_places : int
        Places of each arm beyond those of the study file.
    """
    held = Counter((each.arm, each.standing) for each in study_sessions if each.present)
    return tuple(
        PlaceCounts(
            arm=arm.name,
            wanted=arm.places + more_places,
            done=held[arm.name, "done"],
            active=held[arm.name, "active"],
            stale=held[arm.name, "stale"],
        )
        for arm in arms
    )


def total_places(arms: Sequence[PlaceCounts]) -> PlaceCounts:
    """Return the sums over all arms."""
    return PlaceCounts(
        arm="",
        wanted=sum(arm.wanted for arm in arms),
        done=sum(arm.done for arm in arms),
        active=sum(arm.active for arm in arms),
        stale=sum(arm.stale for arm in arms),
    )


@dataclass(frozen=True, kw_only=True)
class Dropout:
    """Participants who left at one trial.

    Attributes
    ----------
    position : int
        Position of the trial, from 1; 0 before the first trial.
    left : int
        How many left.
    came : int
        How many came as far.
    """

    position: int
    left: int
    came: int


def dropouts(study_sessions: Sequence[SessionProgress]) -> tuple[Dropout, ...]:
    """Return the trials at which participants left, in order; nobody knows where some withdrew."""
    stopped = Counter(each.stands_at for each in study_sessions if each.has_left)
    others = [each for each in study_sessions if each.standing != "withdrawn"]
    return tuple(
        Dropout(
            position=position,
            left=stopped[position],
            came=sum(each.stands_at >= position for each in others),
        )
        for position in sorted(stopped)
    )


MIN_COUNT: Final = 3
"""If fewer have finished, their pace is chance."""

WINDOWS: Final = (timedelta(hours=1), timedelta(hours=6), timedelta(days=1), timedelta(days=7))
"""The shortest in which enough have finished gives the present pace."""

LONGEST_FORECAST: Final = timedelta(days=365)


def forecast(
    finished: Sequence[datetime], remaining: int, began: datetime | None, now: datetime
) -> datetime | str:
    """Return when `remaining` more will have finished, or why nobody can tell.

    Parameters
    ----------
    finished : sequence of datetime
        When participants finished, in any order.
    began : datetime or None
        When the first participant came.
    """
    if remaining == 0:
        return "All places are done"
    if began is None:
        return "Nobody has begun yet"
    for span in WINDOWS:
        since = max(now - span, began)
        recent = sum(moment > since for moment in finished)
        if recent >= MIN_COUNT and now > since:
            left = (now - since) * (remaining / recent)
            return now + left if left <= LONGEST_FORECAST else "At this rate over a year is left"
    return "Too few have finished recently for a forecast"


@dataclass(frozen=True, kw_only=True)
class Completions:
    """Places done over time, as points of a curve.

    Attributes
    ----------
    since, until : datetime
        Ends of the time axis: the first participant, and now or when all will be done.
    done : tuple of (float, float)
        Time and places, each as a share of its axis in [0, 1]; a staircase.
    expected : tuple of (float, float)
        The straight line from now to the projected end; empty where there is none.
    """

    since: datetime
    until: datetime
    done: tuple[tuple[float, float], ...]
    expected: tuple[tuple[float, float], ...]


def completions(
    finished: Sequence[datetime],
    wanted: int,
    began: datetime | None,
    end: datetime | str,
    now: datetime,
) -> Completions | None:
    """Return the places done over time; None if none is done.

    Parameters
    ----------
    finished : sequence of datetime
        When each place that is done was, in any order.
    wanted : int
        Places.
    began, end
        As for and from `forecast`.
    """
    if began is None or not finished:
        return None
    # The curve ends when all places are done.
    until = max(finished) if len(finished) >= wanted else now
    until = until if isinstance(end, str) else end
    most = max(wanted, len(finished))

    def place(moment: datetime) -> float:
        return min(1.0, (moment - began) / max(until - began, timedelta(seconds=1)))

    stairs = [(0.0, 0.0)]
    for done, moment in enumerate(sorted(finished), start=1):
        stairs += [(place(moment), stairs[-1][1]), (place(moment), done / most)]
    today = (place(now), stairs[-1][1])
    return Completions(
        since=began,
        until=until,
        done=(*stairs, today),
        expected=() if isinstance(end, str) else (today, (1.0, 1.0)),
    )
