"""A whole rehearsal: the real server, and simulated participants who take its study at once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from threading import Event
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.resumption import Roster, call_roster, let_time_pass, prepare
from studyapp.rehearsal.server import rehearsal_server
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.visit import Departure, study_client
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder, lock_folder
from studyapp.study.settings.study import Study

SPEED: Final = 100.0
"""How much faster than real a rehearsal's clock runs."""

WORKERS: Final = 8
"""How many simulated participants take part at the same time."""


@dataclass(frozen=True, kw_only=True)
class RehearsalResult:
    """What came of a rehearsal.

    Attributes
    ----------
    completed : int
        Participants who have their completion code, all runs of this rehearsal together.
    kept : int
        How many of them had it before this run.
    left : int
        Participants who left on the way, for good.
    note : str
        What became of an earlier rehearsal in the same folder; empty where there was none.
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
    population: Population | None = None,
    speed: float = SPEED,
    workers: int = WORKERS,
    on_done: Callable[[int, int], None] = lambda _done, _wanted: None,
) -> RehearsalResult:
    """Let simulated participants take the study over real HTTP.

    Their answers are kept in ``rehearsal.db``, their true preferences in ``rehearsal.json``.
    Interrupted and called again with the same study and seed, it goes on where it was.

    Parameters
    ----------
    folder : StudyFolder
        A study whose videos are rendered.
    participants : int, optional
        Of each arm: of each comparison with the reference, or of the study where everybody is
        asked about all conditions. As many as the study asks for by default, and no more.
    seed : int
        Decides the participants, what they prefer and every answer.
    population : Population, optional
        Whom to draw them from; `default_population` of the study by default.
    speed : float
        How much faster than real the rehearsal's clock runs; at least 1.
    workers : int
        How many take part at the same time; it changes no answer.
    on_done : callable
        Called with (finished participants, all participants).

    Raises
    ------
    InputError
        If the study is not ready or being rehearsed already, more participants are asked for
        than it has places, or a page lacks what a participant needs.
    """
    study = ServedStudy.read(folder.root).study
    count = _checked_count(folder, study, participants)
    busy = InputError(
        "this study is being rehearsed already",
        where=folder.root,
        remedy="Wait until the other 'motionjury rehearse' is done, or stop it",
    )
    with lock_folder(folder.root, busy=busy), ExitStack() as opened:
        truth, note = prepare(folder, seed=seed, population=population)
        database = opened.enter_context(closing(Database.open(sqlite_url(folder.rehearsal))))
        roster = call_roster(database, count, truth)
        kept = len(roster.finished)
        on_done(roster.wanted - len(roster.remaining), roster.wanted)
        if roster.remaining:
            server = opened.enter_context(rehearsal_server(folder, speed=speed))
        # Who is excluded or leaves may open the place again, so that somebody else is awaited.
        while roster.remaining:
            let_time_pass(database, roster, study.lease_minutes)
            somebody = Participant(
                name="",
                study=study,
                population=truth.population,
                seed=truth.seed,
                eyes=Eyes(database),
                speed=speed,
                stop=Event(),
            )
            crowd = Crowd(like=somebody, ledger=Ledger(folder.acknowledged), server=server)
            crowd.take_part(roster, workers=workers, on_done=on_done)
            roster = call_roster(database, count, truth)
        let_time_pass(database, roster, study.lease_minutes)
    return RehearsalResult(
        completed=len(roster.finished),
        kept=kept,
        left=len(roster.gone),
        note=note,
    )


def _checked_count(folder: StudyFolder, study: Study, participants: int | None) -> int:
    """Return how many participants come in all, `participants` of them to each arm."""
    arms = study.arms
    if participants is None:
        return sum(arm.places for arm in arms)
    places = min(arm.places for arm in arms)
    if not 1 <= participants <= places:
        each = " of each comparison" if len(arms) > 1 else ""
        raise InputError(
            f"{participants} participants do not fit into the {places} places{each}",
            where=folder.definition,
            remedy="Ask for fewer, or raise the number of participants there",
        )
    return participants * len(arms)


STAGGER: Final = 0.05
"""Seconds between the first arrivals."""


@dataclass(frozen=True, kw_only=True)
class Crowd:
    """The participants of one run, and what they have in common.

    Attributes
    ----------
    like : Participant
        What each of them is but for the name.
    ledger : Ledger
        Where they note what they are told.
    server : str
        Address of the study's server.
    """

    like: Participant
    ledger: Ledger
    server: str

    def take_part(
        self, roster: Roster, *, workers: int, on_done: Callable[[int, int], None]
    ) -> None:
        """Let the rest of `roster` come, `workers` at a time; the first error stops everybody.

        Who leaves to come back comes back after everybody else has come.

        Parameters
        ----------
        roster : Roster
            Who is still to come.
        workers : int
            How many take part at the same time.
        on_done : callable
            Called with the number of those who have finished, or left for good, after each, and
            how many are wanted.

        Raises
        ------
        InputError
            If a page lacks something, or the server is gone.
        """
        away = self.ledger.read().away
        done = roster.wanted - len(roster.remaining)
        with ThreadPoolExecutor(workers, thread_name_prefix="participant") as pool:

            def comes(name: str, *, delay: float, is_back: bool) -> Future[bool]:
                return pool.submit(self._one, name, delay=delay, is_back=is_back)

            try:
                visits = {
                    comes(name, delay=min(index, workers) * STAGGER, is_back=name in away): name
                    for index, name in enumerate(roster.remaining)
                }
                while visits:
                    for visit in wait(visits, return_when=FIRST_COMPLETED).done:
                        name = visits.pop(visit)
                        if visit.result():
                            done += 1
                            on_done(done, roster.wanted)
                        else:
                            visits[comes(name, delay=0.0, is_back=True)] = name
            finally:
                self.like.stop.set()
                pool.shutdown(cancel_futures=True)

    def _one(self, name: str, *, delay: float, is_back: bool) -> bool:
        """Let one participant come; return whether that was for the last time."""
        self.like.stop.wait(delay)
        participant = replace(self.like, name=name, ledger=self.ledger)
        if is_back:
            self.ledger.returned(name)
        try:
            with study_client(self.server) as client:
                participant.take_part(client, is_back=is_back)
        except Departure as departure:
            if departure.returns:
                self.ledger.left(name)
            return not departure.returns
        except httpx.TransportError as error:
            raise InputError(
                f"the study's server does not answer any more ({error})",
                where=self.server,
                remedy="Run the command again: it goes on where it was",
            ) from error
        return True
