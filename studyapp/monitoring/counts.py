"""How many places are done, active, stale and open, when all will be, and who left where."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final

from studyapp.monitoring.study_sessions import SessionProgress
from studyapp.study.design.trial import Arm


@dataclass(frozen=True, kw_only=True)
class PlaceCounts:
    """Places of an arm, or of all.

    Attributes
    ----------
    arm : str
        Empty for all together.
    wanted : int
        How many the study asks for.
    done, active, stale : int
        Held ones, by where their study sessions stand.
    open : int
        Those that nobody holds. More may be held than are wanted, where fewer are wanted than
        before; then none is open.
    """

    arm: str
    wanted: int
    done: int
    active: int
    stale: int

    @property
    def open(self) -> int:
        """Wanted places that nobody holds."""
        return max(0, self.wanted - self.done - self.active - self.stale)

    @property
    def still_to_be_done(self) -> int:
        """How many more must finish."""
        return max(0, self.wanted - self.done)


def count_places(
    arms: Iterable[Arm], study_sessions: Iterable[SessionProgress], more_places: int = 0
) -> tuple[PlaceCounts, ...]:
    """Return the counts of each arm, in the order of the study.

    Parameters
    ----------
    more_places : int
        Places that each arm wants beyond those of the study file.
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


def all_together(arms: Sequence[PlaceCounts]) -> PlaceCounts:
    """Return the counts of all arms together; no arm has places left for another one."""
    return PlaceCounts(
        arm="",
        wanted=sum(arm.wanted for arm in arms),
        done=sum(arm.done for arm in arms),
        active=sum(arm.active for arm in arms),
        stale=sum(arm.stale for arm in arms),
    )


@dataclass(frozen=True, kw_only=True)
class LeftAt:
    """Those who left at one trial.

    Attributes
    ----------
    position : int
        The trial at which they stood, from 1; 0 where they had not begun the trials.
    left : int
    came : int
        How many came as far as that.
    """

    position: int
    left: int
    came: int


@dataclass(frozen=True, kw_only=True)
class Dropouts:
    """All who left.

    Attributes
    ----------
    at : tuple of LeftAt
        By trial; only those at which anybody left.
    withdrawn : int
        Those who said so. Where their answers are deleted, nothing tells at which trial.
    of : int
        How many came in all.
    """

    at: tuple[LeftAt, ...]
    withdrawn: int
    of: int

    @property
    def left(self) -> int:
        """How many left without a word."""
        return sum(each.left for each in self.at)


def dropouts(study_sessions: Sequence[SessionProgress]) -> Dropouts:
    """Return who left of `study_sessions`, and where."""
    stopped = Counter(each.stands_at for each in study_sessions if each.has_left)
    others = [each for each in study_sessions if each.standing != "withdrawn"]
    return Dropouts(
        at=tuple(
            LeftAt(
                position=position,
                left=stopped[position],
                came=sum(each.stands_at >= position for each in others),
            )
            for position in sorted(stopped)
        ),
        withdrawn=sum(each.standing == "withdrawn" for each in study_sessions),
        of=len(study_sessions),
    )


FEWEST: Final = 3
"""With fewer who have finished, their pace is chance."""


LOOKED_BACK: Final = (timedelta(hours=1), timedelta(hours=6), timedelta(days=1), timedelta(days=7))
"""The shortest of these in which enough have finished tells the present pace."""


FARTHEST: Final = timedelta(days=365)


@dataclass(frozen=True, kw_only=True)
class Forecast:
    """When the last place will be done.

    Attributes
    ----------
    at : datetime or None
    reason : str
        Why there is none; empty where there is one.
    """

    at: datetime | None
    reason: str = ""


def forecast(
    finished: Sequence[datetime], remaining: int, began: datetime | None, now: datetime
) -> Forecast:
    """Return when `remaining` more will have finished.

    Parameters
    ----------
    finished : sequence of datetime
        When those finished who have, in any order.
    began : datetime or None
        When the first participant came.
    """
    if remaining == 0:
        return Forecast(at=None, reason="all places are done")
    if began is None:
        return Forecast(at=None, reason="nobody has come yet")
    for span in LOOKED_BACK:
        since = max(now - span, began)
        lately = sum(moment > since for moment in finished)
        if lately >= FEWEST and now > since:
            left = (now - since) * (remaining / lately)
            if left > FARTHEST:
                return Forecast(at=None, reason="at this rate it takes longer than a year")
            return Forecast(at=now + left)
    return Forecast(at=None, reason="too few have finished lately to tell when it is done")


POINTS: Final = 200
"""Moments at which a curve of completions may rise."""


@dataclass(frozen=True, kw_only=True)
class Completions:
    """Places done over time, as points of a drawing.

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
    end: datetime | None,
    now: datetime,
) -> Completions | None:
    """Return how the places became done; None where none is.

    Parameters
    ----------
    finished : sequence of datetime
        When each place that is done was, in any order.
    wanted : int
        Places.
    began : datetime or None
        When the first participant came.
    end : datetime or None
        When the last place will be done, where that can be told.
    """
    if began is None or not finished:
        return None
    # Nothing happens any more where all are done.
    until = end or (max(finished) if len(finished) >= wanted else now)
    whole = max((until - began).total_seconds(), 1.0)
    most = max(wanted, len(finished))

    def place(moment: datetime) -> float:
        return min(1.0, round(POINTS * (moment - began).total_seconds() / whole) / POINTS)

    reached = {place(moment): done for done, moment in enumerate(sorted(finished), start=1)}
    stairs, height = [(0.0, 0.0)], 0.0
    for across, done in reached.items():
        stairs += [(across, height), (across, done / most)]
        height = done / most
    stairs.append((place(now), height))
    return Completions(
        since=began,
        until=until,
        done=tuple(stairs),
        expected=() if end is None else ((place(now), height), (1.0, 1.0)),
    )
