"""Interim figures of a running study, computed once and stored.

The analysis needs hundreds of megabytes for seconds of work, which a server must not load. A
separate process with low priority and limits computes the figures. They are stored in the
database, as any server process on any host may ask for them, and may end meanwhile.
"""

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
from studyapp.database.tables.researchers import AuditLine, Event, ExclusionDecision, InterimFigures
from studyapp.database.tables.study_session import IntakeChange, StudySession, StudyVersion
from studyapp.researchers.audit import StudyState, count_answers
from studyapp.side_process import SideProcessError, output_of

FORMAT: Final = 3
"""Version of the documents; to be raised with each change, so that older ones are recomputed."""

FigureKind = Literal["agreement", "results"]


class Document(BaseModel):
    """Agreement or results so far.

    Attributes
    ----------
    answered, analysed : int
        Participants with at least one analysable answer, and those whom no rule excludes.
    rows : tuple of dict
        Rows of `analysis.results.headline.agreed_so_far` or `headline_numbers`, with the `task` of
        the analysis; `set` is empty without sets.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[3] = FORMAT
    state: StudyState
    answered: int
    analysed: int
    rows: tuple[dict[str, Any], ...] = Field(max_length=10_000)

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Return a stored document; None if it is empty or of another version."""
        try:
            return cls.model_validate_json(text)
        except ValidationError:
            return None


PROGRAM: Final = "studyapp.results.looks"
"""It belongs to a higher layer, and is therefore called by name."""

TIMEOUT_SECONDS: Final = 300
"""100,000 answers take about 15 seconds, and more on a busy machine."""


@dataclass(frozen=True)
class FigureProcess:
    """Computes figures of one study.

    Attributes
    ----------
    folder : Path
        The study folder.
    database_url : str
        Passed in the environment, as it may contain a password.
    """

    folder: Path
    database_url: str

    def begin(self, job: Callable[[], None]) -> None:
        """Run `job` in the background."""
        Thread(target=job, name="figures", daemon=True).start()

    def compute(self, what: FigureKind, *, seconds: float = TIMEOUT_SECONDS) -> str:
        """Return the computed document, or raise `SideProcessError`."""
        environment = {"DATABASE_URL": self.database_url}
        folder = str(self.folder)
        return output_of(PROGRAM, folder, what, seconds=seconds, environment=environment).decode()


MIN_INTERVALS: Final[dict[FigureKind, timedelta]] = {
    "agreement": timedelta(minutes=10),
    "results": timedelta(minutes=1),
}
"""Figures are computed at most this often."""

ABANDONED_AFTER: Final = timedelta(minutes=10)
"""A computation that began longer ago has died."""


@dataclass(frozen=True, kw_only=True)
class StoredFigures:
    """The stored figures of one kind.

    Attributes
    ----------
    answers : int
        The present number of answers.
    document : str
        The last document; empty before the first.
    is_current : bool
        Whether nothing has changed since.
    is_computing : bool
        Whether a new one is being computed.
    problem : str
        Why the last attempt failed; empty if it did not.
    """

    answers: int
    document: str = ""
    is_current: bool = False
    is_computing: bool = False
    problem: str = ""

    @property
    def contents(self) -> Document | None:
        """What the last document holds; None before the first."""
        return Document.read(self.document)


def stored_figures(
    database: Database, clock: Clock, what: FigureKind, figures: FigureProcess
) -> StoredFigures:
    """Return the stored figures, and have them recomputed in the background if that is due.

    Before the first answer there is nothing to compute.
    """
    now = clock.now()
    with database.reading() as session:
        answers, state = count_answers(session), _state(session)
        row = _row(session, what)
    is_due = answers and _is_due(row, state, now, MIN_INTERVALS[what])
    if is_due and _claim(database, what, state, now):
        figures.begin(partial(_compute, database, clock, what, now, figures))
        with database.reading() as session:
            row = _row(session, what)
    if row is None:
        return StoredFigures(answers=answers)
    return StoredFigures(
        answers=answers,
        document=row.document,
        is_current=row.state == state,
        is_computing=_is_running(row, now),
        problem=row.problem,
    )


def _state(session: Session) -> str:
    """Return a digest of what figures depend on: answers, participants and decisions."""
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


def _claim(database: Database, what: FigureKind, state: str, now: datetime) -> bool:
    """Claim the computation for this process; False if another one was first."""
    with database.writing() as session:
        take_turn(session.connection(), Turn.FIGURES)
        row = _row(session, what)
        if not _is_due(row, state, now, MIN_INTERVALS[what]):
            return False
        if row is None:
            row = InterimFigures(what=what, state="", document="", problem="")
            session.add(row)
        row.begun_at = now
        return True


def _compute(
    database: Database, clock: Clock, what: FigureKind, begun: datetime, figures: FigureProcess
) -> None:
    """Compute the figures and store the result."""
    with database.reading() as session:
        state = _state(session)
    try:
        values = {"document": figures.compute(what), "state": state, "problem": ""}
    except SideProcessError as error:
        values = {"problem": str(error)}
    with database.writing() as session:
        session.execute(
            update(InterimFigures)
            # If somebody has been forgotten meanwhile, the row is gone and nothing is stored.
            .where(InterimFigures.what == what, InterimFigures.begun_at == begun)
            .values(begun_at=None, tried_at=clock.now(), **values)
        )
