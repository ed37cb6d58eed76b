"""Lists of study sessions: those that a number of the overview counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from studyapp.database.engine import Database
from studyapp.monitoring.checks import checks, failed_by_sitting
from studyapp.monitoring.counts import LEFT, stands_at
from studyapp.monitoring.study_sessions import Sitting, Standing, sittings
from studyapp.session.served_study import ServedStudy

ROWS: Final = 100
"""Study sessions on one page."""


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Which study sessions are listed; what is None chooses nothing.

    Attributes
    ----------
    standing : Standing or None
    arm : str or None
    left_at : int or None
        Left at this trial; 0 before the first.
    failed : (str, int) or None
        A kind of check, and how many of these were failed.
    earlier : bool
        Those of earlier versions of the study rather than of the present one.
    excluded : bool
        Only those that researchers leave out of the analysis.
    """

    standing: Standing | None = None
    arm: str | None = None
    left_at: int | None = None
    failed: tuple[str, int] | None = None
    earlier: bool = False
    excluded: bool = False


def chosen(database: Database, served: ServedStudy, choice: Choice, now: datetime) -> list[Sitting]:
    """Return the study sessions of `choice`, the newest first."""
    with database.reading() as session:
        found = sittings(session, served, now)
        if choice.failed is not None:
            kind, count = choice.failed
            ids = {each.id for each in found if each.standing != "withdrawn"}
            failures = failed_by_sitting(checks(session, served.study, ids), kind)
            found = [each for each in found if failures.get(each.id) == count]
    return list(reversed([each for each in found if _fits(each, choice)]))


def page_of(found: Sequence[Sitting], number: int) -> Sequence[Sitting]:
    """Return those on page `number`, from 1."""
    return found[(number - 1) * ROWS : number * ROWS]


def pages_of(found: Sequence[Sitting]) -> Iterable[int]:
    """Return the numbers of the pages that show them all."""
    return range(1, max(1, -(-len(found) // ROWS)) + 1)


def _fits(sitting: Sitting, choice: Choice) -> bool:
    left = sitting.standing in LEFT and stands_at(sitting) == choice.left_at
    return (
        sitting.present is not choice.earlier
        and choice.standing in (None, sitting.standing)
        and choice.arm in (None, sitting.arm)
        and (choice.left_at is None or left)
        and (sitting.excluded or not choice.excluded)
    )
