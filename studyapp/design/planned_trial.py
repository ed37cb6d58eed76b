"""One trial as it is planned, before anybody has seen it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from motion.segment import Segment

Kind = Literal["practice", "main", "repeat", "catch"]
Side = Literal["left", "right"]

KINDS: Final[tuple[Kind, ...]] = ("practice", "main", "repeat", "catch")


@dataclass(frozen=True, kw_only=True)
class PlannedTrial:
    """One presentation of a pair.

    Attributes
    ----------
    position : int
        Place within the study session, from 1.
    kind : {'practice', 'main', 'repeat', 'catch'}
        Practice is discarded, repeat is a practice trial shown again and analysed like main,
        catch has a known right answer.
    segment : Segment
        The speech heard with both motions.
    left, right : str
        The conditions under A and under B.
    expected : {'left', 'right'} or None
        The right answer of a catch trial.
    repeats : int or None
        Position of the practice trial that a repeat shows again.
    """

    position: int
    kind: Kind
    segment: Segment
    left: str
    right: str
    expected: Side | None = None
    repeats: int | None = None
