"""Taking everything out of a database but its schema."""

from __future__ import annotations

from studyapp.database.engine import Database
from studyapp.database.tables import Base


def empty(database: Database) -> None:
    """Empty all tables and count from one again; much faster than making a new database."""
    names = [table.name for table in reversed(Base.metadata.sorted_tables)]
    with database.writing() as session:
        connection = session.connection()
        counted = connection.dialect.name == "postgresql"
        if counted:
            connection.exec_driver_sql("SET LOCAL lock_timeout = '20s'")
        for name in names:
            connection.exec_driver_sql(f"DELETE FROM {name}")  # noqa: S608
            if counted:
                connection.exec_driver_sql(f"ALTER SEQUENCE {name}_id_seq RESTART")
