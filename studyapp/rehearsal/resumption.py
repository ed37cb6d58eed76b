"""What of an earlier rehearsal can be gone on with."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import select, update

from motion.errors import InputError
from motion.segment import Segment
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.rehearsal.bookkeeping import Ledger, people
from studyapp.rehearsal.record import Truth, read_truth, write_truth
from studyapp.rehearsal.simulation.population import Population, default_population
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, read_stimuli
from studyapp.study.settings.study import Study

_SQLITE_ENDINGS: Final = ("", "-wal", "-shm")

MOST_GONE: Final = 3
"""Times as many may leave for good, and be replaced, as are asked for."""


@dataclass(frozen=True, kw_only=True)
class Roster:
    """Where the simulated participants of a rehearsal stand, by name.

    Attributes
    ----------
    wanted : int
        How many are asked for.
    finished : tuple of str
        Those who have their completion code, also if they are more than are asked for now.
    gone : tuple of str
        Those who have left for good.
    halfway : tuple of str
        Those asked for who are in the middle of their study session. They are to come back
        before anybody new comes, so that their places are not thought abandoned.
    awaited : tuple of str
        Those asked for who have not come yet.
    """

    wanted: int
    finished: tuple[str, ...]
    gone: tuple[str, ...]
    halfway: tuple[str, ...]
    awaited: tuple[str, ...]

    @property
    def remaining(self) -> tuple[str, ...]:
        """Those who still have to come, in the order they should."""
        return (*self.halfway, *self.awaited)


def prepare(
    folder: StudyFolder, *, seed: int, population: Population | None = None
) -> tuple[Truth, str]:
    """Make the study folder ready for a rehearsal with `seed`, keeping one that fits.

    Returns
    -------
    truth : Truth
        What this rehearsal's participants prefer, as written to ``rehearsal.json``.
    note : str
        What became of an earlier rehearsal, for people; empty where there was none.
    """
    study = folder.study()
    segments = tuple(folder.segments_of(study))
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
        difference = _difference(folder, truth)
        if not difference:
            return truth, "An earlier rehearsal of this study is gone on with."
        note = f"The answers of an earlier rehearsal were removed: {difference}."
    for ending in _SQLITE_ENDINGS:
        folder.rehearsal.with_name(folder.rehearsal.name + ending).unlink(missing_ok=True)
    Ledger(folder.acknowledged).remove()
    write_truth(folder.rehearsal_truth, truth)
    return truth, note


def _digest(study: Study, segments: Sequence[Segment], stimuli: Stimuli) -> str:
    """Return what changes with anything that decides trials, pages or videos of the study."""
    videos = sorted(made.key for made in (*stimuli.clips, *stimuli.pairs, *stimuli.copies))
    # Whom it simulates, the rehearsal itself compares.
    told = study.model_dump(exclude={"rehearsal"})
    state = json.dumps([told, [asdict(segment) for segment in segments], videos])
    return hashlib.sha256(state.encode()).hexdigest()


def _difference(folder: StudyFolder, truth: Truth) -> str:
    """Say why the rehearsal in `folder` cannot be gone on with; empty if it can."""
    try:
        earlier = read_truth(folder.rehearsal_truth)
    except InputError:
        return f"{folder.rehearsal_truth.name} does not tell what they were"
    if earlier.study != truth.study:
        return "the study has changed since"
    if earlier.seed != truth.seed:
        return f"its seed was {earlier.seed}, not {truth.seed}"
    return "" if earlier == truth else "its participants were drawn from another population"


def call_roster(database: Database, count: int, truth: Truth) -> Roster:
    """Return where the simulated participants stand, of whom `count` are asked for.

    For everybody who finished and was excluded, so that the place is open again, one more is
    asked for, at most as many as there are in the first place; and one for everybody who left for
    good, at most `MOST_GONE` times as many.
    """
    with database.reading() as session:
        begun = people(session, truth)
    finished = [each.name for each in begun if each.completed]
    excluded = sum(each.completed and not each.has_place for each in begun)
    gone = [each.name for each in begun if each.has_left]
    wanted = count + min(excluded, count) + min(len(gone), MOST_GONE * count)
    names = [f"rehearsal-{number:05d}" for number in range(wanted)]
    known = {each.name for each in begun}
    over = {*finished, *gone}
    return Roster(
        wanted=wanted,
        finished=tuple(finished),
        gone=tuple(gone),
        halfway=tuple(name for name in names if name in known and name not in over),
        awaited=tuple(name for name in names if name not in known),
    )


def let_time_pass(database: Database, roster: Roster, lease_minutes: int) -> None:
    """Let the leases end of those who left for good, and of nobody else.

    All that they did is set back, since nobody waits that long in a rehearsal; their places are
    then given to others as they are in the study itself. Those in the middle of their study session
    are on their way back, however long ago the rehearsal was stopped.
    """
    now = Clock().now()
    ended = now - timedelta(minutes=lease_minutes + 1)
    with database.writing() as session:
        over = StudySession.recruiter_participant.in_(roster.gone)
        for gone in session.scalars(
            select(StudySession).where(over, StudySession.last_active_at > ended)
        ):
            _set_back(gone, gone.last_active_at - ended)
        session.execute(
            update(StudySession)
            .where(StudySession.recruiter_participant.in_(roster.halfway))
            .values(last_active_at=now)
        )


def _set_back(study_session: StudySession, span: timedelta) -> None:
    for row in (study_session, *study_session.form_answers, *study_session.trials):
        for column in row.__table__.columns:
            value = getattr(row, column.key)
            if isinstance(value, datetime):
                setattr(row, column.key, value - span)
