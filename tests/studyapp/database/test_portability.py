from __future__ import annotations

import pytest
from sqlalchemy import Table
from sqlalchemy.dialects.postgresql.base import PGDialect
from sqlalchemy.dialects.sqlite.base import SQLiteDialect
from sqlalchemy.engine import Dialect
from sqlalchemy.schema import CreateTable

from studyapp.database.tables import Base


@pytest.mark.parametrize("table", Base.metadata.sorted_tables, ids=lambda table: table.name)
@pytest.mark.parametrize("kind", [SQLiteDialect, PGDialect])
def test_every_table_can_be_made_in_both_databases(table: Table, kind: type[Dialect]) -> None:
    statement = str(CreateTable(table).compile(dialect=kind()))

    assert statement.strip().startswith(f"CREATE TABLE {table.name}")
    assert all(f"{column.name} " in statement for column in table.columns)
