"""Researchers for tests, who joined by links."""

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.researchers.account import Role
from studyapp.researchers.links import first_owner_link, invite, join
from studyapp.researchers.logins import find_account_by_login

PASSWORD = "correct horse battery"  # noqa: S105 - it opens nothing but tests
HERE = "192.0.2.1"


def joined(database: Database, clock: Clock, name: str, role: Role = "owner") -> int:
    """Make a researcher, the first one an owner; return the number."""
    token = first_owner_link(database, clock) if role == "owner" else None
    token = token or invite(database, clock, role=role, by="")
    login = join(database, clock, token, name=name, password=PASSWORD)
    account = find_account_by_login(database, login, clock.now(), by_hand=False)
    assert account is not None
    return account.id
