"""Versions of a study: its design cannot change during data collection except on request."""

from datetime import datetime

from sqlalchemy import delete, func, not_, select, tuple_, update
from sqlalchemy.orm import Session

from motion.errors import InputError, listed
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event
from studyapp.database.tables.study_session import Place, StudySession, StudyVersion
from studyapp.researchers.audit import log_change
from studyapp.session.intake import open_places, take_allocation_turn
from studyapp.session.places import STALE, regain_place, stale_before
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.reading import parse_text
from studyapp.study.versioning import design_changes, operation_changes, operation_part


def open_study(
    database: Database,
    served: ServedStudy,
    clock: Clock,
    *,
    new_version: bool = False,
    by: str = "",
) -> None:
    """Prepare the database for `served`: store its version, and open its places.

    Parameters
    ----------
    new_version : bool
        Whether a changed design may become a new version.
    by : str
        The researcher, for the log; empty for the server and the command line.

    Raises
    ------
    InputError
        If the design has changed since somebody took part, without `new_version`.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        _open(session, served, clock.now(), new_version=new_version, by=by)


def needs_new_version(database: Database, design: str) -> bool:
    """Tell whether `design` needs a new version because people took part in another one."""
    with database.reading() as session:
        return _version_left_behind(session, design) is not None


def definition_in_use(database: Database) -> str | None:
    """Return the study file of those who take part; None if nobody has come."""
    with database.reading() as session:
        version = session.scalars(select(StudyVersion).where(StudyVersion.in_force)).first()
        return version.definition if version and _has_participants(session, version) else None


def _open(
    session: Session, served: ServedStudy, now: datetime, *, new_version: bool, by: str
) -> None:
    previous = _version_left_behind(session, served.design)
    if previous is not None and not new_version:
        raise InputError(
            f"the study's design has changed ({_changed_parts(previous, served)}), and people have "
            "taken part in the previous one",
            where="study.toml",
            remedy="Undo the change (the database keeps the previous file), or serve it as a new "
            "version (--new-version): earlier answers are kept apart, and unfinished participants "
            "in changed arms cannot continue",
        )
    query = select(StudyVersion).where(StudyVersion.design == served.design)
    version = session.scalars(query).first() or _create_version(session, served, now, by)
    if not _has_participants(session, version):
        # The exclusion rules count as stated when the first participant comes.
        version.definition = served.definition
    session.execute(update(StudyVersion).values(in_force=StudyVersion.id == version.id))
    _log_operation_changes(session, served, version, now, by)
    _release_outdated_places(session, served)
    open_places(session, served)
    _restore_places(session, served, now)


def _version_left_behind(session: Session, design: str) -> StudyVersion | None:
    """Return the version in force if it has participants and another design."""
    in_force = session.scalars(select(StudyVersion).where(StudyVersion.in_force)).first()
    if in_force is None or in_force.design == design or not _has_participants(session, in_force):
        return None
    return in_force


def _changed_parts(previous: StudyVersion, served: ServedStudy) -> str:
    try:
        before = parse_text(previous.definition, where="study.toml")
    except InputError:
        return "the previous study file is no longer valid"
    return listed(design_changes(before, served.study)) or "the speech or the videos"


def _create_version(session: Session, served: ServedStudy, now: datetime, by: str) -> StudyVersion:
    """Return a version for a new design; it replaces versions without participants."""
    with_participants = select(StudySession.version_id)
    session.execute(delete(StudyVersion).where(StudyVersion.id.not_in(with_participants)))
    last = session.scalars(select(func.max(StudyVersion.number))).one()
    version = StudyVersion(
        number=1 if last is None else last + 1,
        design=served.design,
        definition=served.definition,
        operation=operation_part(served.study),
        opened_at=now,
    )
    session.add(version)
    session.flush()
    if version.number > 1:
        detail = f"version {version.number}"
        log_change(session, now, Event.NEW_VERSION, by=by, detail=detail)
    return version


def _has_participants(session: Session, version: StudyVersion) -> bool:
    """Tell whether anybody has enrolled in `version`."""
    enrolled = select(StudySession.id).where(StudySession.version_id == version.id).limit(1)
    return session.scalars(enrolled).first() is not None


def _log_operation_changes(
    session: Session, served: ServedStudy, version: StudyVersion, now: datetime, by: str
) -> None:
    operation = operation_part(served.study)
    changes = operation_changes(version.operation, operation)
    if changes:
        log_change(session, now, Event.OPERATION_CHANGED, by=by, detail="; ".join(changes))
        version.operation = operation
        session.flush()


def _release_outdated_places(session: Session, served: ServedStudy) -> None:
    """Release the places of unfinished study sessions in arms whose design has changed."""
    unfinished = select(StudySession.id).where(StudySession.completed_at.is_(None))
    session.execute(
        update(Place)
        .where(
            Place.study_session_id.in_(unfinished),
            tuple_(Place.arm, Place.design).not_in(list(served.arms)),
        )
        .values(study_session_id=None)
    )


def _restore_places(session: Session, served: ServedStudy, now: datetime) -> None:
    """Give active participants their places back if their arm's design is served again."""
    placeless = session.scalars(
        select(StudySession)
        .outerjoin(StudySession.place)
        .where(
            Place.id.is_(None),
            StudySession.completed_at.is_(None),
            StudySession.withdrawn_at.is_(None),
            not_(STALE),
        )
        .with_for_update(of=StudySession, skip_locked=True),
        {"silent_since": stale_before(served, now)},
    )
    for study_session in placeless.all():
        regain_place(session, served, study_session)
