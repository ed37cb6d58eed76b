"""Taking everything out of a database but its schema."""

from studyapp.database.engine import Database
from studyapp.database.tables.base import Base


def empty(database: Database) -> None:
    """Empty all tables and reset their counters; much faster than making a new database."""
    names = [table.name for table in reversed(Base.metadata.sorted_tables)]
    with database.writing() as session:
        connection = session.connection()
        if connection.dialect.name == "postgresql":
            restarts = [f"ALTER SEQUENCE {name}_id_seq RESTART" for name in names]
            deletions = [f"DELETE FROM {name}" for name in names]  # noqa: S608
            at_once = "; ".join(["SET LOCAL lock_timeout = '20s'", *deletions, *restarts])
            connection.exec_driver_sql(at_once)
            return
        for name in names:
            connection.exec_driver_sql(f"DELETE FROM {name}")  # noqa: S608
