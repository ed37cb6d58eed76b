"""Noting a few values of a stored row at once.

The unit of work would find out what has changed, and in which order to store it, for every table
there is: that costs more than the statement.
"""

from __future__ import annotations

from functools import cache
from typing import Any, cast

from sqlalchemy import Table, Update, bindparam, update
from sqlalchemy.orm import Session
from sqlalchemy.orm.attributes import set_committed_value

from studyapp.models import StudySession, Trial

ROW = "the_row"


def note(session: Session, row: StudySession | Trial, **values: object) -> None:
    """Store `values` in the columns of the stored `row`; `row` has them afterwards."""
    table = cast(Table, type(row).__table__)
    session.connection().execute(_noting(table, tuple(values)), {ROW: row.id, **values})
    for name, value in values.items():
        set_committed_value(row, name, value)


@cache
def _noting(table: Table, names: tuple[str, ...]) -> Update:
    values: dict[str, Any] = {name: bindparam(name) for name in names}
    return update(table).where(table.c.id == bindparam(ROW)).values(values)
