"""Invitations: links for one person each, to take part or to try the study.

Only a hash of a link is stored. Opening one does not use it up: it always leads to the same study
session. Test participations have a database of their own, so that nothing of them counts.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sqlalchemy import delete, func, select

from motion.errors import InputError
from motion.files import write_text
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.database.scrubbing import scrub
from studyapp.database.tables.base import Base
from studyapp.database.tables.study_session import Invitation, StudySession
from studyapp.researchers.credentials import token_hash
from studyapp.session.intake import add_places, current_intake
from studyapp.session.places import has_open_place
from studyapp.session.served_study import ServedStudy
from studyapp.session.trials import new_token
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder

COLUMNS: Final = ("for", "link")


def invite(folder: StudyFolder, people: Sequence[str], address: str, out: Path) -> int:
    """Add a link for each of `people` to the table `out`, unless it has one already.

    Only the table connects people and links: the study stores neither.

    Parameters
    ----------
    people : sequence of str
        Whom the links are for.
    address : str
        Where the study is served; links begin with it.

    Returns
    -------
    int
        How many links were made.
    """
    start = f"{address.rstrip('/')}/?invitation="
    rows = _read_links(out)
    invited_people = {name for name, _ in rows}
    new_people = [name for name in dict.fromkeys(people) if name not in invited_people]
    if not new_people:
        return 0
    with closing(Database.open(database_url_of(folder.root))) as database:
        tokens = make_invitations(database, len(new_people), Clock())
    links = [start + token for token in tokens]
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerows([COLUMNS, *rows, *zip(new_people, links, strict=True)])
    write_text(out, table.getvalue(), private=True)
    return len(new_people)


def counts(folder: StudyFolder) -> InvitationCounts:
    """Return how many of the study's invitations were used; none before the first was made."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return InvitationCounts()
    with closing(database):
        return invitation_counts(database)


def listed_people(path: Path) -> list[str]:
    """Return the first column of a table with a heading.

    Raises
    ------
    InputError
        If it names nobody.
    """
    people = [row[0].strip() for row in _rows(path)[1:] if row and row[0].strip()]
    if not people:
        raise InputError(
            "nobody is on the list",
            where=path,
            remedy="Give a CSV file with a heading, and one person a line in its first column",
        )
    return people


def _read_links(out: Path) -> list[tuple[str, str]]:
    """Return the rows of the table of links; none if there is no such file."""
    if not out.exists():
        return []
    heading, *rows = _rows(out) or [[]]
    if tuple(heading) != COLUMNS or any(len(row) != len(COLUMNS) for row in rows):
        raise InputError(
            "this is not a table of invitations",
            where=out,
            remedy=f"Move it away; the table's columns are {', '.join(COLUMNS)}",
        )
    return [(name, link) for name, link in rows]


def _rows(path: Path) -> list[list[str]]:
    try:
        return list(csv.reader(io.StringIO(path.read_text("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"the table cannot be read ({error})", where=path, remedy="Save it as CSV in UTF-8"
        ) from None


@dataclass(frozen=True, kw_only=True)
class InvitationCounts:
    """How many invitations were made, and with how many somebody has begun or finished."""

    made: int = 0
    begun: int = 0
    completed: int = 0


def make_invitations(database: Database, count: int, clock: Clock) -> list[str]:
    """Return the tokens of `count` new invitations; nobody can read them again."""
    tokens = [new_token() for _ in range(count)]
    now = clock.now()
    with database.writing() as session:
        session.add_all(Invitation(token_hash=token_hash(token), made_at=now) for token in tokens)
    return tokens


def invited(database: Database, token: str) -> str | None:
    """Return the visit of the invitation's holder, None if this study has no such invitation."""
    query = select(Invitation.token_hash).where(Invitation.token_hash == token_hash(token))
    with database.reading() as session:
        return session.scalars(query).first()


def invitation_counts(database: Database) -> InvitationCounts:
    """Return how many invitations were used."""
    used = select(func.count(StudySession.id), func.count(StudySession.completed_at)).join(
        Invitation, Invitation.token_hash == StudySession.visit
    )
    with database.reading() as session:
        made = session.scalar(select(func.count(Invitation.id))) or 0
        begun, completed = session.execute(used).one()
    return InvitationCounts(made=made, begun=begun, completed=completed)


def make_test_participation(root: Path, served: ServedStudy, clock: Clock, *, by: str) -> str:
    """Return the token of a link for one test participation in the study in folder `root`.

    There is always a place for it: when all are taken, one more opens in each arm.

    Parameters
    ----------
    by : str
        Who asks for it.
    """
    test = served.opened_to_try()
    with closing(Database.open(sqlite_url(StudyFolder(root).tries))) as database:
        open_study(database, test, clock, new_version=True)
        with database.reading() as session:
            is_full = not has_open_place(session, test, current_intake(session), clock.now())
        if is_full:
            add_places(database, test, clock, 1, by=by, reason="every place has been tried")
        (token,) = make_invitations(database, 1, clock)
    return token


def count_test_participations(root: Path) -> int:
    """Return how many test participations were begun in the study in folder `root`."""
    file = StudyFolder(root).tries
    if not file.exists():
        return 0
    with closing(Database.open(sqlite_url(file))) as database:
        return _count(database)


def erase_test_participations(root: Path) -> int:
    """Erase all test participations of the study in folder `root`; return how many there were."""
    file = StudyFolder(root).tries
    if not file.exists():
        return 0
    with closing(Database.open(sqlite_url(file))) as database:
        count = _count(database)
        with database.writing() as session:
            for table in reversed(Base.metadata.sorted_tables):
                session.execute(delete(table))
        scrub(database)
    return count


def _count(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count(StudySession.id))) or 0
