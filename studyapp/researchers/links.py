"""One-time links, with which researchers join a study or replace a lost password.

A link works once, until it expires; only its hash is stored.
"""

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any, Final, Literal

from sqlalchemy import Select, delete, func, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event, Researcher, ResearcherLink
from studyapp.researchers.account import (
    OWNERS,
    Role,
    end_logins,
    find_researcher,
    name_key,
    normalize_name,
)
from studyapp.researchers.audit import log_change
from studyapp.researchers.credentials import check_password, hash_password, new_token, token_hash
from studyapp.researchers.logins import begin_login, set_password

Purpose = Literal["first_owner", "invitation", "new_password"]

LIFETIME: Final = {
    "first_owner": timedelta(days=1),
    "invitation": timedelta(days=3),
    "new_password": timedelta(days=1),
}


@dataclass(frozen=True)
class Link:
    """One usable link.

    Attributes
    ----------
    role : Role or None
        Role of the new account.
    name : str
        The researcher whose password it replaces; empty for a new account.
    """

    id: int
    purpose: Purpose
    role: Role | None
    name: str
    made_by: str
    expires_at: datetime


class UnusableLinkError(InputError):
    """The link was used or revoked, has expired, or never existed."""

    def __init__(self) -> None:
        super().__init__(
            "this link does not work: it has been used, or has expired",
            remedy="Ask an owner for a new one; whoever runs the server can create one with "
            "'motionjury researchers', or with 'motionjury desk' for a desk",
        )


def first_owner_link(database: Database, clock: Clock) -> str | None:
    """Return the token of a link for the first owner; None if there is an owner.

    Earlier links for the first owner stop working.
    """
    with database.writing() as session:
        if session.scalar(OWNERS.limit(1)) is not None:
            return None
        _revoke_first_owner_links(session)
        return _create_link(session, clock.now(), "first_owner", role="owner", made_by="")


def _revoke_first_owner_links(session: Session) -> None:
    session.execute(delete(ResearcherLink).where(ResearcherLink.purpose == "first_owner"))


def invite(database: Database, clock: Clock, *, role: Role, by: str) -> str:
    """Return the token of a link for a new account with `role`."""
    now = clock.now()
    with database.writing() as session:
        log_change(session, now, Event.INVITED, by=by, detail=f"as {role}")
        return _create_link(session, now, "invitation", role=role, made_by=by)


def offer_new_password(database: Database, clock: Clock, *, name: str, by: str) -> str:
    """Return the token of a link for a new password of the researcher `name`.

    Raises
    ------
    InputError
        If there is no such researcher, or they have no access.
    """
    now = clock.now()
    with database.writing() as session:
        researcher = find_researcher(session, name)
        if researcher.disabled_at is not None:
            raise InputError(f"{researcher.name!r} has no access", remedy="An owner can restore it")
        earlier = ResearcherLink.researcher_id == researcher.id
        session.execute(delete(ResearcherLink).where(earlier))
        log_change(session, now, Event.PASSWORD_OFFERED, by=by, detail=f"to {researcher.name}")
        return _create_link(session, now, "new_password", researcher_id=researcher.id, made_by=by)


def list_usable_links(database: Database, now: datetime) -> list[Link]:
    """Return the usable links, the first to expire at the top."""
    query = _usable_links_query(now).order_by(ResearcherLink.expires_at, ResearcherLink.id)
    with database.reading() as session:
        return [Link(*row) for row in session.execute(query)]


def find_link(database: Database, token: str, now: datetime) -> Link:
    """Return the link with this token, without using it, or raise `UnusableLinkError`."""
    query = _usable_links_query(now).where(ResearcherLink.token_hash == token_hash(token))
    with database.reading() as session:
        row = session.execute(query).first()
    if row is None:
        raise UnusableLinkError
    return Link(*row)


def revoke_link(database: Database, clock: Clock, link_id: int, *, by: str) -> None:
    """Revoke a link that has not been used."""
    with database.writing() as session:
        link = session.get(ResearcherLink, link_id)
        if link is not None:
            session.delete(link)
            detail = f"{link.purpose.replace('_', ' ')} of {link.made_by or 'the server'}"
            log_change(session, clock.now(), Event.LINK_TAKEN_BACK, by=by, detail=detail)


def join(
    database: Database,
    clock: Clock,
    token: str,
    *,
    name: str,
    password: str,
    identity: str | None = None,
) -> str:
    """Create an account with a link, and return the token of its first login.

    Parameters
    ----------
    identity : str, optional
        The person's identity, if they have an account elsewhere; see
        `studyapp.database.tables.researchers.Researcher`.

    Raises
    ------
    InputError
        If the link is unusable, the name is taken, the person had access before, or name or
        password is not acceptable.
    """
    now = clock.now()
    link = find_link(database, token, now)
    name = normalize_name(name)
    check_password(password, name=name)
    password_hash = hash_password(password)
    try:
        with database.writing() as session:
            _use_link(session, token, now)
            had_access = select(Researcher.id).where(Researcher.identity == identity)
            if identity is not None and session.scalar(had_access) is not None:
                raise InputError(
                    "you have had an account in this study already, and your access was removed",
                    remedy="Ask an owner of the study to restore it",
                )
            if link.role is None:
                raise UnusableLinkError
            researcher = Researcher(
                name=name,
                name_key=name_key(name),
                role=link.role,
                password_hash=password_hash,
                joined_at=now,
                identity=identity or new_token(),
            )
            session.add(researcher)
            if link.role == "owner":
                _revoke_first_owner_links(session)
            session.flush()
            log_change(session, now, Event.JOINED, by=name, detail=f"as {link.role}")
            return begin_login(session, researcher.id, now)
    except IntegrityError:
        raise InputError(
            f"a researcher {name!r} already exists", remedy="Choose another name"
        ) from None


def choose_password(database: Database, clock: Clock, token: str, *, password: str) -> str | None:
    """Set the password of a researcher with a link, and return the token of a new login.

    Researchers with a second factor get no token: they log in with it.

    Raises
    ------
    InputError
        If the link is unusable, or the password is not acceptable.
    """
    now = clock.now()
    link = find_link(database, token, now)
    check_password(password, name=link.name)
    password_hash = hash_password(password)
    with database.writing() as session:
        researcher_id = _use_link(session, token, now)
        query = select(Researcher).where(Researcher.id == researcher_id).with_for_update()
        researcher = session.scalars(query).first()
        if researcher is None or researcher.disabled_at is not None:
            raise UnusableLinkError
        login = set_password(session, researcher, password_hash, now)
        if researcher.totp_secret is None:
            return login
        end_logins(session, researcher.id)
        return None


def _create_link(
    session: Session,
    now: datetime,
    purpose: Purpose,
    *,
    role: Role | None = None,
    researcher_id: int | None = None,
    made_by: str,
) -> str:
    session.execute(delete(ResearcherLink).where(ResearcherLink.expires_at <= now))
    token = new_token()
    session.add(
        ResearcherLink(
            token_hash=token_hash(token),
            purpose=purpose,
            role=role,
            researcher_id=researcher_id,
            made_at=now,
            expires_at=now + LIFETIME[purpose],
            made_by=made_by,
        )
    )
    return token


def _use_link(session: Session, token: str, now: datetime) -> int | None:
    """Remove the link, and return its researcher; of two simultaneous uses, only one succeeds."""
    used = session.execute(
        delete(ResearcherLink)
        .where(ResearcherLink.token_hash == token_hash(token), ResearcherLink.expires_at > now)
        .returning(ResearcherLink.researcher_id)
    ).first()
    if used is None:
        raise UnusableLinkError
    return used[0]


def _usable_links_query(now: datetime) -> Select[*tuple[Any, ...]]:
    """Select the fields of `Link`."""
    return (
        select(
            ResearcherLink.id,
            ResearcherLink.purpose,
            ResearcherLink.role,
            func.coalesce(Researcher.name, ""),
            ResearcherLink.made_by,
            ResearcherLink.expires_at,
        )
        .outerjoin(Researcher, Researcher.id == ResearcherLink.researcher_id)
        .where(ResearcherLink.expires_at > now, Researcher.disabled_at.is_(None))
    )
