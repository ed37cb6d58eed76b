"""What of an earlier rehearsal can be gone on with."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Final

from sqlalchemy import select

from motion.errors import InputError
from motion.segment import Segment
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import Stimuli, read_stimuli
from studyapp.definition.study import Study
from studyapp.models import Place, StudySession
from studyapp.rehearsal.population import Population, default_population
from studyapp.rehearsal.record import Truth, read_truth, write_truth
from studyapp.rehearsal.truth import expectations
from studyapp.services.database import Database

_SQLITE_ENDINGS: Final = ("", "-wal", "-shm")


@dataclass(frozen=True, kw_only=True)
class Roster:
    """Where the simulated participants of a rehearsal stand, by name.

    Attributes
    ----------
    wanted : int
        How many are asked for.
    finished : tuple of str
        Those who have their completion code, also if they are more than are asked for now.
    halfway : tuple of str
        Those asked for who are in the middle of their study session. They are to come back
        before anybody new comes, so that their places are not thought abandoned.
    awaited : tuple of str
        Those asked for who have not come yet.
    """

    wanted: int
    finished: tuple[str, ...]
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
    write_truth(folder.rehearsal_truth, truth)
    return truth, note


def _digest(study: Study, segments: Sequence[Segment], stimuli: Stimuli) -> str:
    """Return what changes with anything that decides trials, pages or videos of the study."""
    videos = sorted(made.key for made in (*stimuli.clips, *stimuli.pairs, *stimuli.copies))
    state = json.dumps([study.model_dump(), [asdict(segment) for segment in segments], videos])
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


def call_roster(database: Database, count: int) -> Roster:
    """Return where the simulated participants stand, of whom `count` are asked for.

    For everybody who finished and was excluded, so that the place is open again, one more is
    asked for; at most as many as there are in the first place.
    """
    with database.reading() as session:
        rows = session.execute(
            select(StudySession.recruiter_participant, StudySession.completed_at, Place.id).join(
                StudySession.place, isouter=True
            )
        ).all()
    known = {row.recruiter_participant: row.completed_at for row in rows}
    excluded = sum(row.completed_at is not None and row.id is None for row in rows)
    wanted = count + min(excluded, count)
    names = [f"rehearsal-{number:05d}" for number in range(wanted)]
    return Roster(
        wanted=wanted,
        finished=tuple(name for name in known if known[name] is not None),
        halfway=tuple(name for name in names if name in known and known[name] is None),
        awaited=tuple(name for name in names if name not in known),
    )
