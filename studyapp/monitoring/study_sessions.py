"""The standing of every study session, by one statement and a few rules; and lists of them."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime
from typing import Any, Final, Literal, get_args

from sqlalchemy import Select, func, select
from sqlalchemy.orm import Session

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Place, StudySession
from studyapp.database.tables.trial import Trial, Video
from studyapp.monitoring.data_quality import checks, failed_by_session
from studyapp.researchers.exclusion_decisions import current_exclusions
from studyapp.session.places import stale_before
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import state_of

Standing = Literal["done", "replaced", "active", "stale", "unwatched", "lapsed", "withdrawn"]
STANDINGS: Final[tuple[Standing, ...]] = get_args(Standing)

ROWS: Final = 100
"""Study sessions on one page."""


@dataclass(frozen=True, kw_only=True)
class SessionProgress:
    """The progress of one study session.

    Attributes
    ----------
    id : int
        Its number, which identifies nobody.
    arm : str
    present : bool
        Whether its arm belongs to the study as it is served, not to an earlier version.
    standing : Standing
        ``done`` has finished; ``replaced`` has finished, but its place was given to somebody else
        after failed checks; ``active`` and ``stale`` hold a place, the latter silent for so long
        that the next newcomer may get it; ``unwatched`` was ended because too many videos were
        said not to play; ``lapsed`` has lost its place; ``withdrawn`` withdrew.
    trials, settled : int
        Trials planned, and trials answered or skipped; both 0 after a withdrawal.
    left_out : int
        Trials in which a video was said not to play.
    excluded : bool
        Whether a researcher excludes it from the analysis.
    recruiter_participant : str or None
        The recruiter's name for the participant, for owners alone; None without a recruiter.
    failures : int or None
        Failed catch trials and attention checks, in lists alone; None before the first check.
    """

    id: int
    arm: str
    present: bool
    standing: Standing
    consented_at: datetime
    started_at: datetime | None
    last_active_at: datetime
    completed_at: datetime | None
    trials: int
    settled: int
    left_out: int = 0
    excluded: bool = False
    recruiter_participant: str | None = None
    failures: int | None = None

    @property
    def seconds(self) -> float | None:
        """From the first trial to the end, or to the last activity."""
        if self.started_at is None:
            return None
        return ((self.completed_at or self.last_active_at) - self.started_at).total_seconds()

    @property
    def has_left(self) -> bool:
        """Whether the participant has been silent for longer than a place is kept."""
        return self.standing in ("stale", "lapsed")

    @property
    def stands_at(self) -> int:
        """The position of the present trial; 0 before the first, one more than all at the end."""
        return 0 if self.started_at is None else self.settled + 1


STORED: Final = tuple(
    {each.name for each in fields(SessionProgress)} - {"present", "standing", "failures"}
)
"""Fields that the database holds."""


def progress_of_sessions(
    session: Session, served: ServedStudy, now: datetime, *, only: int | None = None
) -> list[SessionProgress]:
    """Return every study session, the first one first; or `only` that of one number."""
    silent_since = stale_before(served, now)
    rows: Sequence[Any] = session.connection().execute(_query(only)).all()
    return [
        SessionProgress(
            present=(row.arm, row.arm_design) in served.arms,
            standing=_standing(row, silent_since),
            **{name: getattr(row, name) for name in STORED},
        )
        for row in rows
    ]


def _standing(row: Any, silent_since: datetime) -> Standing:
    state = state_of(row)
    if state == "completed":
        return "replaced" if row.place is None else "done"
    if state in ("withdrawn", "unwatched", "lapsed"):
        return state
    return "stale" if row.last_active_at < silent_since else "active"


def _query(only: int | None) -> Select[*tuple[Any, ...]]:
    """Select the rows of all study sessions, or of `only` one."""
    planned = select(
        Trial.study_session_id.label("owner"),
        func.count().label("trials"),
        (func.count(Trial.answered_at) + func.count(Trial.unplayable_at)).label("settled"),
    ).group_by(Trial.study_session_id)
    if only is not None:
        planned = planned.where(Trial.study_session_id == only)
    of_trials = planned.subquery()
    failing = select(Trial.study_session_id.label("owner"), func.count().label("left_out"))
    failing = failing.join(Video, Video.trial_id == Trial.id)
    failing = failing.where(Video.unplayable_at.is_not(None)).group_by(Trial.study_session_id)
    of_videos = failing.subquery()
    by_hand = current_exclusions().subquery()
    query = (
        select(
            StudySession.id,
            StudySession.arm,
            StudySession.arm_design,
            StudySession.consented_at,
            StudySession.started_at,
            StudySession.last_active_at,
            StudySession.completed_at,
            StudySession.withdrawn_at,
            StudySession.outcome,
            StudySession.recruiter_participant,
            Place.id.label("place"),
            by_hand.c.study_session_id.is_not(None).label("excluded"),
            func.coalesce(of_trials.c.trials, 0).label("trials"),
            func.coalesce(of_trials.c.settled, 0).label("settled"),
            func.coalesce(of_videos.c.left_out, 0).label("left_out"),
        )
        .outerjoin(of_trials, of_trials.c.owner == StudySession.id)
        .outerjoin(of_videos, of_videos.c.owner == StudySession.id)
        .outerjoin(Place, Place.study_session_id == StudySession.id)
        .outerjoin(by_hand, by_hand.c.study_session_id == StudySession.id)
        .order_by(StudySession.id)
    )
    return query if only is None else query.where(StudySession.id == only)


Order = Literal["number", "recruiter", "duration", "failures"]
"""The keys by which a list can be sorted."""

ORDERS: Final[tuple[Order, ...]] = get_args(Order)

_KEYS: Final[Mapping[Order, Callable[[SessionProgress], float | str | None]]] = {
    "number": lambda each: each.id,
    "recruiter": lambda each: each.recruiter_participant,
    "duration": lambda each: each.seconds,
    "failures": lambda each: each.failures,
}


@dataclass(frozen=True, kw_only=True)
class Selection:
    """Which study sessions to list, and in which order; None selects all.

    Attributes
    ----------
    standing : Standing or None
    arm : str or None
    left_at : int or None
        Left at this trial; 0 before the first.
    failed : (str, int) or None
        A kind of check, and how many of them were failed.
    earlier : bool
        Those of earlier versions of the study, instead of the present one.
    excluded : bool
        Only those that researchers exclude from the analysis.
    order : Order
    rising : bool
        Whether to sort in ascending order. Missing values come last either way.
    """

    standing: Standing | None = None
    arm: str | None = None
    left_at: int | None = None
    failed: tuple[str, int] | None = None
    earlier: bool = False
    excluded: bool = False
    order: Order = "number"
    rising: bool = False


def list_study_sessions(
    database: Database, served: ServedStudy, selection: Selection, now: datetime
) -> list[SessionProgress]:
    """Return the study sessions of `selection`, in its order; equal ones by number."""
    with database.reading() as session:
        study_sessions = progress_of_sessions(session, served, now)
        ids = {each.id for each in study_sessions if each.standing != "withdrawn"}
        judged_checks = checks(session, served.study, ids)
    if selection.failed is not None:
        kind, count = selection.failed
        failed = failed_by_session(judged_checks, kind)
        study_sessions = [each for each in study_sessions if failed.get(each.id) == count]
    failures: Counter[int] = Counter()
    for check in judged_checks:
        failures[check.study_session] += check.failed
    listed = [
        replace(each, failures=failures.get(each.id))
        for each in study_sessions
        if _is_selected(each, selection)
    ]
    return _sorted(listed, selection)


def _sorted(listed: Sequence[SessionProgress], selection: Selection) -> list[SessionProgress]:
    key = _KEYS[selection.order]
    known = [(value, each) for each in listed if (value := key(each)) is not None]
    known.sort(key=lambda pair: pair[0], reverse=not selection.rising)
    return [each for _, each in known] + [each for each in listed if key(each) is None]


def rows_on_page(listed: Sequence[SessionProgress], number: int) -> Sequence[SessionProgress]:
    """Return the rows on page `number`, from 1."""
    return listed[(number - 1) * ROWS : number * ROWS]


def page_numbers(listed: Sequence[SessionProgress]) -> Iterable[int]:
    """Return the numbers of all pages."""
    return range(1, max(1, -(-len(listed) // ROWS)) + 1)


def _is_selected(study_session: SessionProgress, selection: Selection) -> bool:
    left = study_session.has_left and study_session.stands_at == selection.left_at
    return (
        study_session.present is not selection.earlier
        and selection.standing in (None, study_session.standing)
        and selection.arm in (None, study_session.arm)
        and (selection.left_at is None or left)
        and (study_session.excluded or not selection.excluded)
    )
