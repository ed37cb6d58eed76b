"""Counts of places, and who left where."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

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
