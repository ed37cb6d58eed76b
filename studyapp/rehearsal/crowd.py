"""Many simulated participants at once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from threading import Event
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.rehearsal.browser import by_browser
from studyapp.rehearsal.connection import study_client
from studyapp.rehearsal.examiner import Examiners
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.participant import Participant, answer_trial, fill_form
from studyapp.rehearsal.probes import Probe
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.resumption import Roster
from studyapp.rehearsal.visit import Departure
from studyapp.study.settings.study import Study

STAGGER: Final = 0.05
"""Seconds between the first arrivals."""


def by_http(participant: Participant, server: str, is_back: bool) -> None:
    """Let `participant` take part without a browser."""
    with study_client(server) as client:
        participant.take_part(client, is_back=is_back)


@dataclass(frozen=True, kw_only=True)
class Crowd:
    """The participants of one run, and what they have in common.

    Attributes
    ----------
    study : Study
        What they take part in.
    truth : Truth
        Whom they are drawn from, and with which seed.
    eyes : Eyes
        How they see through the blinding.
    ledger : Ledger
        Where they note what they are told.
    server : str
        Address of the study's server.
    speed : float
        How much faster than real its clock runs.
    examiners : Examiners
        Who tries bad submissions, and which were tried.
    in_browser : frozenset of str
        Who of them takes part in a real browser.
    stop : Event
        Tells all of them to stop.
    """

    study: Study
    truth: Truth
    eyes: Eyes
    ledger: Ledger
    server: str
    speed: float
    examiners: Examiners
    in_browser: frozenset[str] = frozenset()
    stop: Event = field(default_factory=Event)

    @property
    def probes(self) -> list[Probe]:
        """Bad submissions that were tried."""
        return self.examiners.probes

    def take_part(self, roster: Roster, *, workers: int, on_done: Callable[[int], None]) -> None:
        """Let the rest of `roster` come, `workers` at a time; the first error stops everybody.

        One of those who are new tries bad submissions on every kind of page; where that one leaves
        on the way, the next who comes does. Who leaves to come back comes back after everybody
        else has come.

        Parameters
        ----------
        roster : Roster
            Who is still to come.
        workers : int
            How many take part at the same time.
        on_done : callable
            Called with the number of those who have finished, or left for good, after each.

        Raises
        ------
        InputError
            If a page lacks something, something bad is not refused, or the server is gone.
        """
        away = self.ledger.read().away
        with ThreadPoolExecutor(workers, thread_name_prefix="participant") as pool:

            def comes(name: str, *, delay: float, is_back: bool) -> Future[bool]:
                may_examine = name in roster.awaited and name not in self.in_browser and not is_back
                return pool.submit(
                    self._one, name, delay=delay, is_back=is_back, may_examine=may_examine
                )

            try:
                visits = {
                    comes(name, delay=min(index, workers) * STAGGER, is_back=name in away): name
                    for index, name in enumerate(roster.remaining)
                }
                done = 0
                while visits:
                    for visit in wait(visits, return_when=FIRST_COMPLETED).done:
                        name = visits.pop(visit)
                        if visit.result():
                            done += 1
                            on_done(done)
                        else:
                            visits[comes(name, delay=0.0, is_back=True)] = name
            finally:
                self.stop.set()
                pool.shutdown(cancel_futures=True)

    def _one(self, name: str, *, delay: float, is_back: bool, may_examine: bool) -> bool:
        """Let one participant come; return whether that was for the last time."""
        self.stop.wait(delay)
        examiner = self.examiners.one(name, self.study, self.eyes, may_begin=may_examine)
        participant = Participant(
            name=name,
            study=self.study,
            population=self.truth.population,
            seed=self.truth.seed,
            eyes=self.eyes,
            speed=self.speed,
            stop=self.stop,
            answer=examiner.answer if examiner else answer_trial,
            fill=examiner.fill if examiner else fill_form,
            ledger=self.ledger,
        )
        if is_back:
            self.ledger.returned(name)
        try:
            takes_part = by_browser if name in self.in_browser else by_http
            takes_part(participant, self.server, is_back)
        except Departure as departure:
            if departure.returns:
                self.ledger.left(name)
            else:
                self.examiners.left(name)
            return not departure.returns
        except httpx.TransportError as error:
            raise InputError(
                f"the study's server does not answer any more ({error})",
                where=self.server,
                remedy="Run the command again: it goes on where it was",
            ) from error
        return True
