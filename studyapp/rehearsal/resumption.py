"""Continuing an earlier rehearsal."""

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import select, update

from motion.errors import InputError
from motion.segment import Segment
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.rehearsal.bookkeeping import people
from studyapp.rehearsal.simulation.population import Population, default_population
from studyapp.rehearsal.simulation.truth import Truth, expectations, read_truth, write_truth
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, read_stimuli
from studyapp.study.settings.study import Study

MAX_DROPOUT_FACTOR: Final = 3
"""Dropouts that are replaced, relative to the requested participants."""


@dataclass(frozen=True, kw_only=True)
class Roster:
    """The names of a rehearsal's simulated participants, by their state.

    Attributes
    ----------
    total : int
        Number of requested participants, replacements included.
    finished : tuple of str
        Participants with a completion code, even if they are more than requested now.
    dropouts : tuple of str
        Participants who left for good.
    started : tuple of str
        Participants in the middle of their study session, who come back before new ones arrive, so
        that their places do not expire.
    awaited : tuple of str
        Participants who have not arrived yet.
    """

    total: int
    finished: tuple[str, ...]
    dropouts: tuple[str, ...]
    started: tuple[str, ...]
    awaited: tuple[str, ...]

    @property
    def remaining(self) -> tuple[str, ...]:
        """Participants still to come, in order."""
        return (*self.started, *self.awaited)


def prepare(
    folder: StudyFolder, *, seed: int, population: Population | None = None
) -> tuple[Truth, str]:
    """Prepare the study folder for a rehearsal with `seed`, which may continue an earlier one.

    Returns
    -------
    truth : Truth
        The preferences in ``rehearsal.json``.
    note : str
        What became of an earlier rehearsal; may be empty.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    stimuli = read_stimuli(folder.stimuli)
    population = population or default_population(study)
    truth = Truth(
        seed=seed,
        study=_digest(study, segments, stimuli),
        population=population,
        expected=expectations(study, segments, population=population, seed=seed),
    )
    note = ""
    if folder.rehearsal.exists():
        with suppress(InputError):
            if read_truth(folder.rehearsal_truth) == truth:
                return truth, "An earlier rehearsal of this study is continued."
        note = "The answers of an earlier rehearsal (other study, seed or people) were removed."
    for ending in ("", "-wal", "-shm"):
        folder.rehearsal.with_name(folder.rehearsal.name + ending).unlink(missing_ok=True)
    folder.acknowledged.unlink(missing_ok=True)
    write_truth(folder.rehearsal_truth, truth)
    return truth, note


def _digest(study: Study, segments: Sequence[Segment], stimuli: Stimuli) -> str:
    """Return a digest of everything that determines trials, pages or videos of the study."""
    videos = sorted(video.key for video in (*stimuli.clips, *stimuli.pairs, *stimuli.copies))
    # The simulated population is compared separately.
    settings = study.model_dump(exclude={"rehearsal"})
    state = json.dumps([settings, [asdict(segment) for segment in segments], videos])
    return hashlib.sha256(state.encode()).hexdigest()


def read_roster(database: Database, count: int, truth: Truth) -> Roster:
    """Return the state of the simulated participants, of whom `count` are requested.

    Participants who finished but lost their place by an exclusion are replaced, up to `count`;
    so are dropouts, up to `MAX_DROPOUT_FACTOR` times `count`.
    """
    with database.reading() as session:
        arrived = people(session, truth)
    finished = [person.name for person in arrived if person.completed]
    excluded = sum(person.completed and not person.has_place for person in arrived)
    dropouts = [person.name for person in arrived if person.has_left]
    total = count + min(excluded, count) + min(len(dropouts), MAX_DROPOUT_FACTOR * count)
    names = [f"rehearsal-{number:05d}" for number in range(total)]
    known = {person.name for person in arrived}
    ended = {*finished, *dropouts}
    return Roster(
        total=total,
        finished=tuple(finished),
        dropouts=tuple(dropouts),
        started=tuple(name for name in names if name in known and name not in ended),
        awaited=tuple(name for name in names if name not in known),
    )


def expire_leases(database: Database, roster: Roster, lease_minutes: int) -> None:
    """Let the leases of dropouts expire, but not those of other participants.

    Since nobody waits that long in a rehearsal, all times of dropouts are shifted back; the study
    then gives their places to others. Started participants stay active, however long ago the
    rehearsal was stopped.
    """
    now = Clock().now()
    ended = now - timedelta(minutes=lease_minutes + 1)
    with database.writing() as session:
        dropped_out = StudySession.recruiter_participant.in_(roster.dropouts)
        for study_session in session.scalars(
            select(StudySession).where(dropped_out, StudySession.last_active_at > ended)
        ):
            _shift_back(study_session, study_session.last_active_at - ended)
        session.execute(
            update(StudySession)
            .where(StudySession.recruiter_participant.in_(roster.started))
            .values(last_active_at=now)
        )


def _shift_back(study_session: StudySession, span: timedelta) -> None:
    for row in (study_session, *study_session.form_answers, *study_session.trials):
        for column in row.__table__.columns:
            value = getattr(row, column.key)
            if isinstance(value, datetime):
                setattr(row, column.key, value - span)
