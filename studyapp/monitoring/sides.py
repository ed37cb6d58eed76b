"""Whether conditions were shown equally often on the left and on the right."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from studyapp.database.tables import Trial, TrialStimulus
from studyapp.monitoring.answered_trials import ANALYSED

MOST_SPREADS: Final = 3.0
"""Hardly any condition comes farther from one half by chance, in standard errors of a fair coin."""


@dataclass(frozen=True, kw_only=True)
class Sides:
    """How often a condition was shown on either side of a pair.

    Attributes
    ----------
    left, right : int
        In trials that have been answered and are analysed.
    """

    condition: str
    left: int
    right: int

    @property
    def shown(self) -> int:
        """How often in all."""
        return self.left + self.right

    @property
    def balanced(self) -> bool:
        """Whether chance alone may well have shared the sides out like this."""
        if self.shown == 0:
            return True
        spread = 0.5 * math.sqrt(self.shown)
        return abs(self.left - self.shown / 2) <= MOST_SPREADS * spread


def shown_on_sides(session: Session) -> dict[tuple[str, int], int]:
    """Count how often each condition had number 1 or 2 in answered pairs."""
    judged = (
        select(TrialStimulus.trial_id)
        .where(TrialStimulus.number > 0)
        .group_by(TrialStimulus.trial_id)
        .having(func.count() == len(("left", "right")))
    )
    rows = (
        session.connection()
        .execute(
            select(TrialStimulus.condition, TrialStimulus.number, func.count())
            .join(Trial, Trial.id == TrialStimulus.trial_id)
            .where(
                Trial.answered_at.is_not(None),
                Trial.kind.in_(ANALYSED),
                TrialStimulus.number > 0,
                TrialStimulus.trial_id.in_(judged),
            )
            .group_by(TrialStimulus.condition, TrialStimulus.number)
        )
        .all()
    )
    return {(condition, number): count for condition, number, count in rows}


def sides(counts: Mapping[tuple[str, int], int]) -> tuple[Sides, ...]:
    """Return the sides of each condition, by name."""
    conditions: Iterable[str] = sorted({condition for condition, _ in counts})
    return tuple(
        Sides(
            condition=condition,
            left=counts.get((condition, 1), 0),
            right=counts.get((condition, 2), 0),
        )
        for condition in conditions
    )
