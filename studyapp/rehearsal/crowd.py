"""Many simulated participants at once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from threading import Event
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.definition.study import Study
from studyapp.rehearsal.connection import study_client
from studyapp.rehearsal.examiner import Examiner
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Participant, answer_trial, fill_form
from studyapp.rehearsal.probes import Probe
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.resumption import Roster

STAGGER: Final = 0.05
"""Seconds between the first arrivals."""


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
    server : str
        Address of the study's server.
    speed : float
        How much faster than real its clock runs.
    stop : Event
        Tells all of them to stop.
    probes : list of Probe
        Bad submissions that were tried.
    """

    study: Study
    truth: Truth
    eyes: Eyes
    server: str
    speed: float
    stop: Event = field(default_factory=Event)
    probes: list[Probe] = field(default_factory=list)

    def take_part(self, roster: Roster, *, workers: int, on_done: Callable[[int], None]) -> None:
        """Let the rest of `roster` come, `workers` at a time; the first error stops everybody.

        The first who is new tries bad submissions on every kind of page.

        Parameters
        ----------
        roster : Roster
            Who is still to come.
        workers : int
            How many take part at the same time.
        on_done : callable
            Called with the number of those who have finished, after each.

        Raises
        ------
        InputError
            If a page lacks something, something bad is not refused, or the server is gone.
        """
        with ThreadPoolExecutor(workers, thread_name_prefix="participant") as pool:
            try:
                visits = [
                    pool.submit(
                        self._one,
                        name,
                        delay=min(index, workers) * STAGGER,
                        probing=name in roster.awaited[:1],
                    )
                    for index, name in enumerate(roster.remaining)
                ]
                for done, visit in enumerate(as_completed(visits), start=1):
                    visit.result()
                    on_done(done)
            finally:
                self.stop.set()
                pool.shutdown(cancel_futures=True)

    def _one(self, name: str, *, delay: float, probing: bool) -> None:
        self.stop.wait(delay)
        examiner = Examiner(name=name, study=self.study, eyes=self.eyes, probes=self.probes)
        participant = Participant(
            name=name,
            study=self.study,
            population=self.truth.population,
            seed=self.truth.seed,
            eyes=self.eyes,
            speed=self.speed,
            stop=self.stop,
            answer=examiner.answer if probing else answer_trial,
            fill=examiner.fill if probing else fill_form,
        )
        with study_client(self.server) as client:
            try:
                participant.take_part(client)
            except httpx.TransportError as error:
                raise InputError(
                    f"the study's server does not answer any more ({error})",
                    where=self.server,
                    remedy="Run the command again: it goes on where it was",
                ) from error
