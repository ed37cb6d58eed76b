"""Making invitations, for so many people or for a list of them."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import write_text
from studyapp.clock import Clock
from studyapp.definition.folder import StudyFolder
from studyapp.services.database import Database, database_url_of
from studyapp.services.recruiting.invitations import (
    InvitationCounts,
    invitation_counts,
    make_invitations,
)

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
    database = Database.open(database_url_of(folder.root))
    try:
        tokens = make_invitations(database, len(wanted), Clock())
    finally:
        database.close()
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
    try:
        return invitation_counts(database)
    finally:
        database.close()


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
            "this is no table of invitations",
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
