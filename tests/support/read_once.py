"""Reading one state of a database with what reads from an open session."""

from __future__ import annotations

from collections.abc import Callable
from typing import Concatenate, ParamSpec, TypeVar

from sqlalchemy.orm import Session

from studyapp.database.engine import Database

Asked = ParamSpec("Asked")
Found = TypeVar("Found")


def read_once(
    database: Database,
    reader: Callable[Concatenate[Session, Asked], Found],
    *args: Asked.args,
    **kwargs: Asked.kwargs,
) -> Found:
    """Return what `reader` finds in `database`."""
    with database.reading() as session:
        return reader(session, *args, **kwargs)
