"""A rehearsal: the real server, and simulated participants who take its study in parallel."""

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from threading import Event
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.rehearsal import SPEED
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Departure, Participant, study_client
from studyapp.rehearsal.resumption import Roster, expire_leases, prepare, read_roster
from studyapp.rehearsal.server import rehearsal_server
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

WORKERS: Final = 8
"""Number of simulated participants at the same time."""


@dataclass(frozen=True, kw_only=True)
class RehearsalResult:
    """The result of a rehearsal.

    Attributes
    ----------
    completed : int
        Participants with a completion code, in all runs of this rehearsal.
    kept : int
        Those of them from earlier runs.
    left : int
        Participants who dropped out.
    note : str
        What became of an earlier rehearsal in the same folder; may be empty.
    """

    completed: int
    kept: int
    left: int
    note: str


def rehearse(
    folder: StudyFolder,
    *,
    participants: int | None = None,
    seed: int = 1,
    speed: float = SPEED,
    workers: int = WORKERS,
    on_done: Callable[[int, int], None] = lambda _done, _total: None,
) -> RehearsalResult:
    """Let simulated participants take the study over real HTTP.

    Answers are stored in ``rehearsal.db``, true preferences in ``rehearsal.json``. An interrupted
    rehearsal continues when it is called again with the same study and seed.

    Parameters
    ----------
    folder : StudyFolder
        A study with rendered videos.
    participants : int, optional
        Participants of each arm, at most and by default its places.
    seed : int
        Determines the participants, their preferences and all answers.
    speed : float
        Speed of the rehearsal's clock, relative to real time; at least 1.
    workers : int
        Number of participants at the same time, which does not affect answers.
    on_done : callable
        Called with (finished participants, all participants).

    Raises
    ------
    InputError
        If the study is not ready or already being rehearsed, there are more participants than
        places, or a page lacks something that a participant needs.
    """
    study = ServedStudy.read(folder.root).study
    count = _count_participants(folder, study, participants)
    with folder.locked(), ExitStack() as opened:
        truth, note = prepare(folder, seed=seed)
        database = opened.enter_context(closing(Database.open(sqlite_url(folder.rehearsal))))
        roster = read_roster(database, count, truth)
        kept = len(roster.finished)
        on_done(roster.total - len(roster.remaining), roster.total)
        if roster.remaining:
            server = opened.enter_context(rehearsal_server(folder, speed=speed))
        # An exclusion or a dropout may release a place for another participant.
        while roster.remaining:
            expire_leases(database, roster, study.lease_minutes)
            anybody = Participant(
                name="",
                study=study,
                population=truth.population,
                seed=truth.seed,
                eyes=Eyes(database),
                speed=speed,
                stop=Event(),
                ledger=Ledger(folder.acknowledged),
            )
            _let_take_part(roster, anybody, server, workers=workers, on_done=on_done)
            roster = read_roster(database, count, truth)
        expire_leases(database, roster, study.lease_minutes)
    return RehearsalResult(
        completed=len(roster.finished),
        kept=kept,
        left=len(roster.dropouts),
        note=note,
    )


def _count_participants(folder: StudyFolder, study: Study, participants: int | None) -> int:
    """Return the total number of participants, with `participants` in each arm."""
    arms = study.arms
    if participants is None:
        return sum(arm.places for arm in arms)
    places = min(arm.places for arm in arms)
    if not 1 <= participants <= places:
        unit = " of each comparison" if len(arms) > 1 else ""
        raise InputError(
            f"{participants} participants do not fit into the {places} places{unit}",
            where=folder.definition,
            remedy="Reduce --participants, or increase the number of participants there",
        )
    return participants * len(arms)


STAGGER_SECONDS: Final = 0.05
"""Between the first arrivals."""


def _let_take_part(
    roster: Roster,
    anybody: Participant,
    server: str,
    *,
    workers: int,
    on_done: Callable[[int, int], None],
) -> None:
    """Let the remaining participants of `roster` take part; the first error stops all.

    Participants who leave and come back do so after all others have arrived.

    Parameters
    ----------
    anybody : Participant
        A participant without a name.
    server : str
        Address of the study's server.

    Raises
    ------
    InputError
        If a page lacks something, or the server does not answer.
    """
    done = roster.total - len(roster.remaining)
    with ThreadPoolExecutor(workers, thread_name_prefix="participant") as pool:

        def submit(name: str, delay: float) -> Future[bool]:
            return pool.submit(_visit, replace(anybody, name=name), server, delay=delay)

        try:
            visits = {
                submit(name, min(index, workers) * STAGGER_SECONDS): name
                for index, name in enumerate(roster.remaining)
            }
            while visits:
                for visit in wait(visits, return_when=FIRST_COMPLETED).done:
                    name = visits.pop(visit)
                    if visit.result():
                        done += 1
                        on_done(done, roster.total)
                    else:
                        visits[submit(name, 0.0)] = name
        finally:
            anybody.stop.set()
            pool.shutdown(cancel_futures=True)


def _visit(person: Participant, server: str, *, delay: float) -> bool:
    """Let somebody take part; return whether they are finished or gone."""
    person.stop.wait(delay)
    is_back = person.name in person.ledger.read().left
    try:
        with study_client(server) as client:
            person.take_part(client, is_back=is_back)
    except Departure as departure:
        return not departure.returns
    except httpx.TransportError as error:
        raise InputError(
            f"the study's server no longer answers ({error})",
            where=server,
            remedy="Run the command again to continue",
        ) from error
    return True
