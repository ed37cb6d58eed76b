"""Invitations: links for one person each, to take part or to try the study.

What is stored of a link is a hash. Looking at one uses nothing up. Who begins by it has one study
session, and comes back to it by the same link. Test participations have a database of their own, so
that nothing of them counts.
"""

from __future__ import annotations

import csv
import io
import secrets
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
from studyapp.database.scrubbing import leave_nothing
from studyapp.database.tables import Base, Invitation, StudySession
from studyapp.researchers.credentials import token_hash
from studyapp.session.intake import extend, present_intake
from studyapp.session.places import has_open_place
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder

COLUMNS: Final = ("for", "link")


def invite(folder: StudyFolder, people: Sequence[str], address: str, out: Path) -> int:
    """Add a link for each of `people` to the table `out`; who has one in it gets no other.

    Only the table says whose link is whose: the study stores neither names nor links.

    Parameters
    ----------
    people : sequence of str
        Whom the links are for, as the researcher calls them.
    address : str
        Where the study is served; links begin with it.

    Returns
    -------
    int
        How many links were made.
    """
    written = _written(out)
    known = {name for name, _ in written}
    wanted = [name for name in dict.fromkeys(people) if name not in known]
    if not wanted:
        return 0
    with closing(Database.open(database_url_of(folder.root))) as database:
        tokens = make_invitations(database, len(wanted), Clock())
    links = [f"{address.rstrip('/')}/?invitation={token}" for token in tokens]
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerows([COLUMNS, *written, *zip(wanted, links, strict=True)])
    write_text(out, table.getvalue(), private=True)
    return len(wanted)


def counts(folder: StudyFolder) -> InvitationCounts:
    """Return how far the study's invitations have got."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return InvitationCounts(made=0, begun=0, completed=0)
    with closing(database):
        return invitation_counts(database)


def numbered(count: int, out: Path) -> list[str]:
    """Return names for `count` more links than the table `out` has."""
    before = len(_written(out))
    return [f"invitation {before + number}" for number in range(1, count + 1)]


def listed_people(path: Path) -> list[str]:
    """Return the first column of a table with a heading.

    Raises
    ------
    InputError
        If nobody is in it.
    """
    people = [row[0].strip() for row in _rows(path)[1:] if row and row[0].strip()]
    if not people:
        raise InputError(
            "nobody is on the list",
            where=path,
            remedy="Give a CSV file with a heading, and one person a line in its first column",
        )
    return people


def _written(out: Path) -> list[tuple[str, str]]:
    """Return the rows of the table of links; none where there is no such file."""
    if not out.exists():
        return []
    heading, *rows = _rows(out) or [[]]
    if tuple(heading) != COLUMNS or any(len(row) != len(COLUMNS) for row in rows):
        raise InputError(
            "this is not a table of invitations",
            where=out,
            remedy=f"Name another file with --out; its columns are {', '.join(COLUMNS)}",
        )
    return [(name, link) for name, link in rows]


def _rows(path: Path) -> list[list[str]]:
    try:
        return list(csv.reader(io.StringIO(path.read_text("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"the table cannot be read ({error})", where=path, remedy="Save it as CSV in UTF-8"
        ) from None


BYTES: Final = 24


@dataclass(frozen=True, kw_only=True)
class InvitationCounts:
    """How many invitations there are, and by how many somebody has begun or finished."""

    made: int
    begun: int
    completed: int


def make_invitations(database: Database, count: int, clock: Clock) -> list[str]:
    """Return the tokens of `count` new invitations; nobody can read them again."""
    tokens = [secrets.token_urlsafe(BYTES) for _ in range(count)]
    now = clock.now()
    with database.writing() as session:
        session.add_all(Invitation(token_hash=token_hash(token), made_at=now) for token in tokens)
    return tokens


def invited(database: Database, token: str) -> str | None:
    """Return what stands for the invitation's holder, None where it is none of this study."""
    wanted = select(Invitation.token_hash).where(Invitation.token_hash == token_hash(token))
    with database.reading() as session:
        return session.scalars(wanted).first()


def invitation_counts(database: Database) -> InvitationCounts:
    """Return how far the invitations have got."""
    used = select(func.count(StudySession.id), func.count(StudySession.completed_at)).join(
        Invitation, Invitation.token_hash == StudySession.visit
    )
    with database.reading() as session:
        made = session.scalar(select(func.count(Invitation.id))) or 0
        begun, completed = session.execute(used).one()
    return InvitationCounts(made=made, begun=begun, completed=completed)


def make_test_participation(root: Path, served: ServedStudy, clock: Clock, *, by: str) -> str:
    """Return the token of a link by which somebody can try the study in folder `root` once.

    There is always a place for it: where all were tried, one more opens in each arm.

    Parameters
    ----------
    by : str
        Who asks for it.
    """
    tried = served.opened_to_try()
    with closing(Database.open(sqlite_url(StudyFolder(root).tries))) as database:
        open_study(database, tried, clock, new_version=True)
        with database.reading() as session:
            is_full = not has_open_place(session, tried, present_intake(session), clock.now())
        if is_full:
            extend(database, tried, clock, 1, by=by, reason="every place has been tried")
        (token,) = make_invitations(database, 1, clock)
    return token


def count_test_participations(root: Path) -> int:
    """Return how many people have begun to try the study in folder `root`."""
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
        leave_nothing(database)
    return count


def _count(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count(StudySession.id))) or 0
