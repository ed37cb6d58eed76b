"""Reading one state of a database with what reads from an open session."""

from collections.abc import Callable
from typing import Any, TypeVar

from studyapp.database.engine import Database

Found = TypeVar("Found")


def read_once(database: Database, reader: Callable[..., Found], *args: Any, **kwargs: Any) -> Found:
    """Return what `reader` finds in `database`."""
    with database.reading() as session:
        return reader(session, *args, **kwargs)
