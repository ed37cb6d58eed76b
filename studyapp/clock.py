"""The server's clock: what it says about time passing, no participant's browser can change."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime


@dataclass(frozen=True, kw_only=True)
class Clock:
    """Real time, and how much of it counts as having passed for a participant.

    Attributes
    ----------
    speed : float
        Seconds that count for each real second. Only a rehearsal, whose simulated participants
        must not sit through the videos, has another one than 1.
    """

    speed: float = 1.0

    def now(self) -> datetime:
        """Return the present moment in UTC, whatever the speed."""
        return datetime.now(UTC)

    def seconds_since(self, moment: datetime) -> float:
        """Return the seconds that count as passed since `moment`, never negative."""
        return max(0.0, (self.now() - moment).total_seconds() * self.speed)
