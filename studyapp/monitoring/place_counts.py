"""How many places are done, active, stale and open, by arm."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from studyapp.monitoring.study_sessions import Sitting
from studyapp.study.design.arm import Arm


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
    arms: Iterable[Arm], sittings: Iterable[Sitting], more_places: int = 0
) -> tuple[PlaceCounts, ...]:
    """Return the counts of each arm, in the order of the study.

    Parameters
    ----------
    more_places : int
        Places that each arm wants beyond those of the study file.
    """
    held = Counter((sitting.arm, sitting.standing) for sitting in sittings if sitting.present)
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
