"""Researchers for tests, who joined by links."""

from __future__ import annotations

from studyapp.database.engine import Database
from studyapp.researchers.account import Role
from studyapp.researchers.links import first_owner_link, invite, join
from studyapp.researchers.logins import find_account_by_login, log_in
from tests.support.studies.taking_part_steps import SetClock

PASSWORD = "correct horse battery"  # noqa: S105 - it opens nothing but tests
HERE = "192.0.2.1"


def joined(database: Database, clock: SetClock, name: str, role: Role = "owner") -> int:
    """Make a researcher, the first one an owner; return the number."""
    token = first_owner_link(database, clock) if role == "owner" else None
    token = token or invite(database, clock, role=role, by="")
    login = join(database, clock, token, name=name, password=PASSWORD)
    return number_of(database, clock, login)


def number_of(database: Database, clock: SetClock, login: str) -> int:
    account = find_account_by_login(database, login, clock.now(), by_hand=False)
    assert account is not None
    return account.id


def enter(
    database: Database,
    clock: SetClock,
    name: str,
    password: str = PASSWORD,
    address: str = HERE,
) -> str:
    return log_in(database, clock, name=name, password=password, address=address)
