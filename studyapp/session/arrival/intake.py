"""Whether newcomers are let in, and how many places are wanted, as researchers decide it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, cast, get_args

from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import IntakeChange
from studyapp.session.served_study import ServedStudy

IntakeState = Literal["open", "paused", "closed"]
STATES: Final[tuple[IntakeState, ...]] = get_args(IntakeState)


@dataclass(frozen=True, kw_only=True)
class Intake:
    """What researchers have decided; see `studyapp.database.tables.IntakeChange`."""

    state: IntakeState = "open"
    more_places: int = 0


NEWEST: Final = select(IntakeChange.id).order_by(IntakeChange.id.desc()).limit(1)
NEWEST_STATE: Final = NEWEST.with_only_columns(IntakeChange.state).scalar_subquery()
NEWEST_MORE_PLACES: Final = NEWEST.with_only_columns(IntakeChange.more_places).scalar_subquery()


def present_intake(session: Session) -> Intake:
    """Return what holds now."""
    return intake_of(*session.execute(select(NEWEST_STATE, NEWEST_MORE_PLACES)).one())


def intake_of(state: str | None, more_places: int | None) -> Intake:
    """Return the newest decision; None stands for both where there was none."""
    if state is None or more_places is None:
        return Intake()
    return Intake(state=cast(IntakeState, state), more_places=more_places)


def wanted_places(served: ServedStudy, intake: Intake) -> Mapping[tuple[str, str], int]:
    """Return how many places each arm wants, by its name and design."""
    return {key: arm.places + intake.more_places for key, arm in served.arms.items()}
