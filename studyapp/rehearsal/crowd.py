"""Many simulated participants at once."""

from __future__ import annotations

from collections.abc import Callable, Collection
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.rehearsal.browser import by_browser
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.resumption import Roster
from studyapp.rehearsal.visit import Departure, study_client

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
    in_browser : collection of str
        Who of them takes part in a real browser.
    """

    like: Participant
    ledger: Ledger
    server: str
    in_browser: Collection[str] = ()

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
            if name in self.in_browser:
                by_browser(participant, self.server, is_back)
            else:
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
