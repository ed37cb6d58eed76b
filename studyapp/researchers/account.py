"""Researchers' accounts, roles and rights. The table of rights alone decides who may do what."""

import hashlib
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import Enum
from typing import Final, Literal, cast, get_args

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event, Researcher, ResearcherLogin
from studyapp.researchers.audit import log_change

MIN_NAME_LENGTH: Final = 2
MAX_NAME_LENGTH: Final = 100


def normalize_name(given: str) -> str:
    """Return a name as it is stored.

    Raises
    ------
    InputError
        If it is too short or too long, or holds what cannot be seen.
    """
    name = " ".join(unicodedata.normalize("NFC", given).split())
    if not MIN_NAME_LENGTH <= len(name) <= MAX_NAME_LENGTH or not name.isprintable():
        raise InputError(
            f"a name has {MIN_NAME_LENGTH} to {MAX_NAME_LENGTH} letters, all of them visible",
            remedy="Use your name or your e-mail address",
        )
    return name


def name_key(name: str) -> str:
    """Return a key that is the same for all spellings of a name, and storable in any database."""
    folded = unicodedata.normalize("NFKC", " ".join(name.split())).casefold()
    seen = "".join(letter for letter in folded if letter.isprintable())
    return seen[: 2 * MAX_NAME_LENGTH]


def name_hash(name: str) -> str:
    """Return the hash under which login attempts as `name` are counted."""
    return hashlib.sha256(name_key(name).encode("utf-8", "replace")).hexdigest()


Role = Literal["owner", "analyst", "viewer"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)


class Right(Enum):
    """Something that a researcher may do, and its description."""

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
    """Who a researcher is; see `studyapp.database.tables.researchers.Researcher`."""

    id: int
    name: str
    role: Role
    joined_at: datetime
    disabled_at: datetime | None
    has_second_factor: bool
    identity: str | None

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
        identity=row.identity,
    )


def find_researcher(session: Session, name: str) -> Researcher:
    """Lock and return the researcher `name`, or raise `InputError`."""
    query = select(Researcher).where(Researcher.name_key == name_key(name)).with_for_update()
    researcher = session.scalars(query).first()
    if researcher is None:
        raise InputError(
            f"there is no researcher {name!r}",
            remedy="Check the name; 'motionjury researchers STUDY list' lists those of a study",
        )
    return researcher


OWNERS: Final = select(Researcher.id).where(
    Researcher.role == "owner", Researcher.disabled_at.is_(None)
)


def list_accounts(database: Database) -> list[Account]:
    """Return all researchers in the order in which they joined."""
    with database.reading() as session:
        return [
            account_of(row) for row in session.scalars(select(Researcher).order_by(Researcher.id))
        ]


def find_account_by_identity(database: Database, identity: str) -> Account | None:
    """Return the account of a person; None if they have none, or no access."""
    query = select(Researcher).where(
        Researcher.identity == identity, Researcher.disabled_at.is_(None)
    )
    with database.reading() as session:
        researcher = session.scalars(query).first()
    return None if researcher is None else account_of(researcher)


def has_owner(database: Database) -> bool:
    """Tell whether the study has an owner."""
    with database.reading() as session:
        return session.scalars(OWNERS.limit(1)).first() is not None


def change_role(
    database: Database, clock: Clock, researcher_id: int, role: Role, *, by: str
) -> None:
    """Give a researcher another role; they must log in again.

    Raises
    ------
    InputError
        If there is no such researcher, or no owner would remain.
    """
    with database.writing() as session:
        researcher = _lock_researcher(session, researcher_id)
        if researcher.role == role:
            return
        if role != "owner":
            _require_another_owner(session, researcher)
        detail = f"{researcher.name}: {researcher.role} becomes {role}"
        researcher.role = role
        end_logins(session, researcher.id)
        log_change(session, clock.now(), Event.ROLE_CHANGED, by=by, detail=detail)


def set_access(
    database: Database, clock: Clock, researcher_id: int, *, allowed: bool, by: str
) -> None:
    """Restore a researcher's access, with the old password, or remove it and end their logins.

    Their actions stay in the log.

    Raises
    ------
    InputError
        If there is no such researcher, or no owner would remain.
    """
    now = clock.now()
    with database.writing() as session:
        researcher = _lock_researcher(session, researcher_id)
        if not allowed:
            _require_another_owner(session, researcher)
            end_logins(session, researcher.id)
        if (researcher.disabled_at is None) is not allowed:
            researcher.disabled_at = None if allowed else now
            event = Event.LET_IN_AGAIN if allowed else Event.SHUT_OUT
            log_change(session, now, event, by=by, detail=researcher.name)


def _lock_researcher(session: Session, researcher_id: int) -> Researcher:
    """Return a researcher; all accounts stay locked, so that nobody else changes the owners."""
    query = select(Researcher).order_by(Researcher.id).with_for_update()
    for researcher in session.scalars(query).all():
        if researcher.id == researcher_id:
            return researcher
    raise InputError("there is no such researcher", remedy="Open the list of researchers again")


def _require_another_owner(session: Session, leaving: Researcher) -> None:
    others = OWNERS.where(Researcher.id != leaving.id)
    if leaving.role == "owner" and session.scalar(others.limit(1)) is None:
        raise InputError(
            f"{leaving.name!r} is the only owner, and one is needed",
            remedy="Make somebody else an owner first",
        )


def end_logins(session: Session, researcher_id: int) -> None:
    """Log a researcher out everywhere."""
    session.execute(delete(ResearcherLogin).where(ResearcherLogin.researcher_id == researcher_id))
