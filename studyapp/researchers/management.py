"""Who may see the pages of researchers, managed without them: for who is locked out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.researchers.account import Account
from studyapp.researchers.links import invite, offer_new_password
from studyapp.researchers.membership import accounts
from studyapp.researchers.roles import Role
from studyapp.researchers.second_factor import reset_second_factor
from studyapp.study.folder import StudyFolder


def listed_researchers(folder: StudyFolder) -> list[Account]:
    """Return all researchers; nobody where the study has no database yet."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return []
    try:
        return accounts(database)
    finally:
        database.close()


def invitation(folder: StudyFolder, role: Role) -> str:
    """Return the path of a one-time link with which somebody joins as `role`."""
    with _opened(folder) as database:
        return _path(invite(database, Clock(), role=role, by=""))


def link_for_new_password(folder: StudyFolder, name: str) -> str:
    """Return the path of a one-time link with which the researcher `name` gets a new password.

    Raises
    ------
    InputError
        If there is no such researcher, or they are shut out.
    """
    with _opened(folder) as database:
        return _path(offer_new_password(database, Clock(), name=name, by=""))


def without_second_factor(folder: StudyFolder, name: str) -> None:
    """Let the researcher `name`, whose device is lost, log in without a code.

    Raises
    ------
    InputError
        If there is no such researcher.
    """
    with _opened(folder) as database:
        reset_second_factor(database, Clock(), name=name)


@contextmanager
def _opened(folder: StudyFolder) -> Iterator[Database]:
    database = Database.open(database_url_of(folder.root))
    try:
        yield database
    finally:
        database.close()


def _path(token: str) -> str:
    return f"research/join/{token}"
