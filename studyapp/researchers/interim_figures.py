"""What is computed of the answers while the study goes on, so that nothing is computed twice.

The analysis loads what a server must not: hundreds of megabytes, for seconds of work now and then.
So a process of its own does it, of lower priority and with limits, and hands over its result as
text. What was computed is kept in the database: any server process of any host may ask, and any may
go away meanwhile.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from studyapp.clock import Clock, has_passed
from studyapp.database.engine import Database
from studyapp.database.postgresql import Turn, take_turn
from studyapp.database.tables import (
    AuditLine,
    Event,
    ExclusionDecision,
    IntakeChange,
    InterimFigures,
    StudySession,
    StudyVersion,
)
from studyapp.researchers.audit import StudyState, count_answers
from studyapp.side_process import SideProcessError, output_of

FORMAT: Final = 2
"""Of the documents; to be raised where they change, so that older ones are computed anew."""

FigureKind = Literal["agreement", "results"]


class _FrozenModel(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Basis(_FrozenModel):
    """What figures rest on.

    Attributes
    ----------
    finished, planned, answers : int
        How far the study was; see `StudyState`.
    answered, analysed : int
        Participants who gave an answer that counts, and those whom no rule leaves out.
    """

    finished: int
    planned: int
    answers: int
    answered: int
    analysed: int

    @property
    def state(self) -> StudyState:
        """The same, for the log."""
        return StudyState(finished=self.finished, planned=self.planned, answers=self.answers)


class Document(_FrozenModel):
    """Agreement or results so far.

    Attributes
    ----------
    rows : tuple of dict
        Plain data of `analysis.results.headline.AgreedSoFar`, question by question, or of
        `HeadlineNumber`, number by number; each with the `task` that it is analysed by, and
        with an empty `set` where there is one.
    """

    format: Literal[2] = FORMAT
    basis: Basis
    rows: tuple[dict[str, Any], ...] = Field(max_length=10_000)

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Return what was kept; None where nothing was, or by another version."""
        try:
            return cls.model_validate_json(text)
        except ValidationError:
            return None


PROGRAM: Final = "studyapp.results.looks"
"""It belongs to a room above this one, and is called by name, as a stranger would."""

TIMEOUT_SECONDS: Final = 300
"""For 100,000 answers it takes about 15, and longer where it has to give way to others."""


class NoFiguresError(Exception):
    """Nothing was computed; the message says why, in sentences."""


@dataclass(frozen=True)
class FigureProcess:
    """Computes figures of one study.

    Attributes
    ----------
    folder : Path
        The study folder.
    database_url : str
        Where the answers are; handed over in the environment, since it may hold a password.
    """

    folder: Path
    database_url: str

    def begin(self, job: Callable[[], None]) -> None:
        """Have `job` done while the server goes on."""
        Thread(target=job, name="figures", daemon=True).start()

    def compute(self, what: FigureKind, *, seconds: float = TIMEOUT_SECONDS) -> str:
        """Return the document that the process hands over.

        Raises
        ------
        NoFiguresError
            If the process says why it cannot, fails, or takes too long.
        """
        try:
            found = output_of(
                PROGRAM,
                str(self.folder),
                what,
                seconds=seconds,
                environment={"DATABASE_URL": self.database_url},
            )
        except subprocess.TimeoutExpired:
            raise NoFiguresError(
                f"It took longer than {seconds:g} seconds and was stopped. 'motionjury report' "
                "takes the time that it needs."
            ) from None
        except OSError as error:
            raise NoFiguresError(f"The process could not be started ({error.strerror}).") from error
        except SideProcessError as error:
            raise NoFiguresError(str(error) or f"It ended with {error.status}.") from None
        return found.decode()


MIN_INTERVALS: Final[dict[FigureKind, timedelta]] = {
    "agreement": timedelta(minutes=10),
    "results": timedelta(minutes=1),
}
"""However many answers come in between, nothing is computed more often."""

ABANDONED_AFTER: Final = timedelta(minutes=10)
"""Whoever began to compute longer ago has gone away."""


@dataclass(frozen=True, kw_only=True)
class StoredFigures:
    """What is known of one kind of figures.

    Attributes
    ----------
    answers : int
        How many there are now.
    document : str
        As it was computed last; empty where it never was.
    is_current : bool
        Whether nothing has changed since.
    is_computing : bool
        Whether it is being computed.
    problem : str
        Why the last attempt failed; empty where it did not.
    """

    answers: int
    document: str
    is_current: bool
    is_computing: bool
    problem: str


def stored_figures(
    database: Database, clock: Clock, what: FigureKind, figures: FigureProcess
) -> StoredFigures:
    """Return what was computed last, and have it computed anew where that is due.

    Computing goes on after this returns. Before anybody has answered there is nothing to compute.
    """
    now = clock.now()
    with database.reading() as session:
        answers, state = count_answers(session), _state(session)
        row = _row(session, what)
    begun = None
    if answers and _is_due(row, state, now, MIN_INTERVALS[what]):
        begun = _claim(database, what, state, now)
    if begun is not None:
        figures.begin(partial(_compute, database, clock, what, begun, figures))
        with database.reading() as session:
            row = _row(session, what)
    is_computing = row is not None and _is_running(row, now)
    if row is None:
        return StoredFigures(
            answers=answers, document="", is_current=False, is_computing=False, problem=""
        )
    return StoredFigures(
        answers=answers,
        document=row.document,
        is_current=row.state == state,
        is_computing=is_computing,
        problem=row.problem,
    )


def _state(session: Session) -> str:
    """Return what figures depend on: answers, who is counted, and what researchers decided."""
    people = select(func.count(StudySession.completed_at), func.count(StudySession.withdrawn_at))
    decided = (
        select(func.max(ExclusionDecision.id)),
        select(func.max(IntakeChange.id)),
        select(func.max(StudyVersion.id)),
        select(func.max(AuditLine.id)).where(AuditLine.event == Event.OPERATION_CHANGED),
    )
    numbers = (
        FORMAT,
        count_answers(session),
        *session.execute(people).one(),
        *(session.scalar(query) or 0 for query in decided),
    )
    return "-".join(map(str, numbers))


def _row(session: Session, what: FigureKind) -> InterimFigures | None:
    return session.scalars(select(InterimFigures).where(InterimFigures.what == what)).first()


def _is_running(row: InterimFigures, now: datetime) -> bool:
    return row.begun_at is not None and not has_passed(ABANDONED_AFTER, row.begun_at, now)


def _is_due(row: InterimFigures | None, state: str, now: datetime, rest: timedelta) -> bool:
    if row is None or row.tried_at is None:
        return row is None or not _is_running(row, now)
    changed = row.state != state or bool(row.problem)
    return changed and has_passed(rest, row.tried_at, now) and not _is_running(row, now)


def _claim(database: Database, what: FigureKind, state: str, now: datetime) -> datetime | None:
    """Claim the computing for this process; None where another one was first."""
    with database.writing() as session:
        take_turn(session.connection(), Turn.FIGURES)
        row = _row(session, what)
        if not _is_due(row, state, now, MIN_INTERVALS[what]):
            return None
        if row is None:
            row = InterimFigures(what=what, state="", document="", problem="")
            session.add(row)
        row.begun_at = now
        return now


def _compute(
    database: Database, clock: Clock, what: FigureKind, begun: datetime, figures: FigureProcess
) -> None:
    """Compute, and keep what comes of it."""
    with database.reading() as session:
        state = _state(session)
    try:
        values = {"document": figures.compute(what), "state": state, "problem": ""}
    except NoFiguresError as error:
        values = {"problem": str(error)}
    with database.writing() as session:
        session.execute(
            update(InterimFigures)
            # Somebody may have been forgotten meanwhile: then it is kept no longer.
            .where(InterimFigures.what == what, InterimFigures.begun_at == begun)
            .values(begun_at=None, tried_at=clock.now(), **values)
        )
