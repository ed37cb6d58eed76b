"""The log of changes: who did what, when and why. Lines are only ever added."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Final

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.models import AuditLine
from studyapp.services.database import Database

LINES: Final = 200
"""As many are shown at once."""

LONGEST_REASON: Final = 500

ERASED: Final = "(erased)"
"""What stands in place of what would name or describe somebody who is to be forgotten."""


@dataclass(frozen=True, kw_only=True)
class LoggedChange:
    """One line of the log; see `studyapp.models.AuditLine`."""

    id: int
    at: datetime
    researcher: str
    event: str
    detail: str
    reason: str


def reason_given(text: str) -> str:
    """Return a reason in a researcher's words, on one line.

    Raises
    ------
    InputError
        If there is none, it is too long, or it cannot be stored.
    """
    reason = " ".join(text.split())
    storable = "\0" not in reason and reason == reason.encode("utf-8", "ignore").decode("utf-8")
    if not 1 <= len(reason) <= LONGEST_REASON or not storable:
        raise InputError(
            f"a reason of 1 to {LONGEST_REASON} letters is needed",
            remedy="It stands in the log, for whoever asks later",
        )
    return reason


def log_change(
    session: Session,
    now: datetime,
    event: str,
    *,
    by: str,
    detail: str = "",
    reason: str = "",
) -> None:
    """Add a line to the log, stored with what it tells of or not at all.

    Parameters
    ----------
    event : str
        What was done, as a few words.
    by : str
        The researcher's name; empty for the command line.
    """
    line = AuditLine(at=now, event=event, detail=detail, researcher=by, reason=reason)
    session.add(line)


def logged_changes(database: Database, *, before: int | None = None) -> list[LoggedChange]:
    """Return the newest `LINES` lines of the log, the newest first; of those older than `before`.

    Parameters
    ----------
    before : int, optional
        The `id` of a line.
    """
    query = select(AuditLine).order_by(AuditLine.id.desc()).limit(LINES)
    if before is not None:
        query = query.where(AuditLine.id < before)
    with database.reading() as session:
        return [
            LoggedChange(
                id=line.id,
                at=line.at,
                researcher=line.researcher,
                event=line.event,
                detail=line.detail,
                reason=line.reason,
            )
            for line in session.scalars(query)
        ]
