"""The server's clock: what it says about time passing, no participant's browser can change.

It can be set back, by an hour as well: stored moments are to come then. How long ago they were,
nobody knows, and nobody is to wait until the clock has reached them again.
"""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Final

APART: Final = timedelta(minutes=1)
"""What the clocks of several servers of a study may differ by."""


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

    def seconds_since(self, moment: datetime) -> float | None:
        """Return the seconds that count as passed since `moment`; None where nobody knows."""
        passed = (self.now() - moment).total_seconds()
        return passed * self.speed if passed >= 0 else None


def has_passed(span: timedelta, since: datetime, now: datetime) -> bool:
    """Tell whether `span` has passed since a moment; so it has where nobody knows."""
    return not -APART <= now - since < span
