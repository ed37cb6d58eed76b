"""A researcher's account without the password, and what each role may do.

Pages ask this table of rights; nothing else decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import Enum
from typing import Final, Literal, cast, get_args

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.tables import Researcher
from studyapp.researchers.names import name_key

Role = Literal["owner", "analyst", "viewer"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)


class Right(Enum):
    """Something that a researcher may do; the value says it in words."""

    KEEP_ACCOUNT = "change their own password, and log out"
    WATCH = "see how the study goes, what happened in each study session, and previews of trials"
    READ = "read what participants said about themselves, and the log of changes"
    STEER = "pause, resume, extend and close the study, and exclude participants from the analysis"
    UNBLIND = "look at results before the end, which is logged"
    NAME = "see by which name a recruiter knows a participant"
    MANAGE = "invite researchers, change their roles, and remove their access"


RIGHTS: Final[Mapping[Role, frozenset[Right]]] = {
    "viewer": frozenset({Right.KEEP_ACCOUNT, Right.WATCH}),
    "analyst": frozenset({Right.KEEP_ACCOUNT, Right.WATCH, Right.READ, Right.STEER, Right.UNBLIND}),
    "owner": frozenset(Right),
}


@dataclass(frozen=True, kw_only=True)
class Account:
    """Who a researcher is; see `studyapp.database.tables.Researcher`."""

    id: int
    name: str
    role: Role
    joined_at: datetime
    disabled_at: datetime | None
    has_second_factor: bool

    def may(self, right: Right) -> bool:
        """Tell whether this researcher has `right`."""
        return self.disabled_at is None and right in RIGHTS[self.role]


def account_of(row: Researcher) -> Account:
    """Return the account that `row` stores."""
    return Account(
        id=row.id,
        name=row.name,
        role=cast(Role, row.role),
        joined_at=row.joined_at,
        disabled_at=row.disabled_at,
        has_second_factor=row.totp_secret is not None,
    )


def researcher_named(session: Session, name: str) -> Researcher:
    """Return the researcher `name`, kept from other writers until stored.

    Raises
    ------
    InputError
        If there is none.
    """
    query = select(Researcher).where(Researcher.name_key == name_key(name)).with_for_update()
    found = session.scalars(query).first()
    if found is None:
        raise InputError(
            f"there is no researcher {name!r}",
            remedy="See who there is with 'motionjury researchers STUDY list'",
        )
    return found
