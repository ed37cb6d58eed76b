"""Carrying a database's rows across a step that makes its tables anew.

Altering a table of SQLite means dropping it, and dropping a table deletes what refers to it. A
step that changes many tables therefore takes all rows out, makes the tables anew, and puts the
rows back in their new shape.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import sqlalchemy as sa

Row = dict[str, Any]
Rows = dict[str, list[Row]]


def take_out(connection: sa.Connection, tables: Sequence[str]) -> Rows:
    """Return the rows of `tables` and drop these; children must come before their parents."""
    rows: Rows = {}
    for name in tables:
        table = sa.Table(name, sa.MetaData(), autoload_with=connection, resolve_fks=False)
        found = connection.execute(sa.select(table).order_by(table.c.id))
        rows[name] = [dict(row) for row in found.mappings()]
        table.drop(connection)
    return rows


def put_in(connection: sa.Connection, rows: Mapping[str, Sequence[Row]]) -> None:
    """Insert `rows` with the ids they have; parents must come before their children."""
    for name, made in rows.items():
        if not made:
            continue
        table = sa.Table(name, sa.MetaData(), autoload_with=connection, resolve_fks=False)
        connection.execute(table.insert(), list(made))
        if connection.dialect.name == "postgresql":
            # Ids that were given by hand do not move the counter of the next ones.
            counter = sa.func.pg_get_serial_sequence(name, "id")
            highest = sa.select(sa.func.max(table.c.id)).scalar_subquery()
            connection.execute(sa.select(sa.func.setval(counter, highest)))
