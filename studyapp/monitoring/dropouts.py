"""Who left before the end, and at which trial."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.monitoring.study_sessions import Sitting

LEFT: Final = ("stale", "lapsed")
"""Who has been silent for longer than a place is kept."""


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


def dropouts(sittings: Sequence[Sitting]) -> Dropouts:
    """Return who left of `sittings`, and where."""
    stopped = Counter(stands_at(each) for each in sittings if each.standing in LEFT)
    others = [each for each in sittings if each.standing != "withdrawn"]
    return Dropouts(
        at=tuple(
            LeftAt(
                position=position,
                left=stopped[position],
                came=sum(stands_at(each) >= position for each in others),
            )
            for position in sorted(stopped)
        ),
        withdrawn=sum(each.standing == "withdrawn" for each in sittings),
        of=len(sittings),
    )


def stands_at(sitting: Sitting) -> int:
    """Return the position of the trial that a study session is at; 0 before the first one.

    Who has settled all of them stands behind the last.
    """
    return 0 if sitting.started_at is None else sitting.settled + 1
