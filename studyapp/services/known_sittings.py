"""What a study knows of its participants beside their answers, for the exclusion rules."""

from __future__ import annotations

from collections import defaultdict

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session, selectinload

from analysis.exclusions.sitting import KnownSitting
from motion.errors import InputError
from studyapp.definition.exclusions import ExclusionSection
from studyapp.definition.reading import parse_text
from studyapp.definition.study import Study
from studyapp.models import StudySession, StudyVersion, Trial
from studyapp.services.database import Database
from studyapp.services.exclusion import JUDGED, failures


def known_sittings(database: Database, study: Study) -> dict[str, KnownSitting]:
    """Return what is known of every study session, under its number as in the export.

    Who withdrew is left out. What was failed is judged by the version of the study that the
    participant took part in; by `study` where that cannot be read any more.
    """
    with database.reading() as session:
        versions = {
            version.id: _read(version) or study for version in session.scalars(select(StudyVersion))
        }
        settled = Trial.answered_at.is_not(None) | Trial.unplayable_at.is_not(None)
        counted = session.execute(
            select(
                StudySession.id,
                StudySession.version_id,
                func.count(Trial.id),
                func.count(Trial.id).filter(settled),
            )
            .outerjoin(StudySession.trials)
            .where(_present())
            .group_by(StudySession.id, StudySession.version_id)
            .order_by(StudySession.id)
        ).all()
        judged = _judged(session)
        return {
            str(number): _known(versions[version], judged[number], trials=trials, settled=done)
            for number, version, trials, done in counted
        }


def rules_before_answers(database: Database) -> tuple[ExclusionSection, ...] | None:
    """Return the exclusion rules that the study stated when the first participant came.

    Returns
    -------
    tuple of ExclusionSection, or None
        In order; None where nobody has come, or where the study file of that time cannot be read.
    """
    first = (
        select(StudyVersion)
        .where(StudyVersion.id.in_(select(StudySession.version_id)))
        .order_by(StudyVersion.number)
        .limit(1)
    )
    with database.reading() as session:
        version = session.scalars(first).first()
        study = None if version is None else _read(version)
    return None if study is None else study.settled_exclusions


def _known(study: Study, judged: list[Trial], *, trials: int, settled: int) -> KnownSitting:
    failed = failures(study, judged)
    return KnownSitting(
        trials=trials,
        settled=settled,
        failed_catch=failed["catch"],
        failed_attention=failed["attention"],
    )


def _judged(session: Session) -> defaultdict[int, list[Trial]]:
    """Return the catch trials and attention checks that were answered, by study session."""
    found: defaultdict[int, list[Trial]] = defaultdict(list)
    for trial in session.scalars(
        select(Trial)
        .join(Trial.study_session)
        .where(_present(), Trial.kind.in_(JUDGED), Trial.answered_at.is_not(None))
        .order_by(Trial.id)
        .options(selectinload(Trial.responses), selectinload(Trial.stimuli))
    ):
        found[trial.study_session_id].append(trial)
    return found


def _present() -> ColumnElement[bool]:
    return StudySession.withdrawn_at.is_(None)


def _read(version: StudyVersion) -> Study | None:
    try:
        return parse_text(version.definition, where=f"version {version.number}")
    except InputError:
        return None
