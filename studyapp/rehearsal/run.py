"""A whole rehearsal: the real server, and simulated participants who take the study through it."""

from __future__ import annotations

import ssl
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from threading import Event
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.definition.study import Study
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.lock import only_rehearsal
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.participant import Participant, Visit, answer_trial
from studyapp.rehearsal.population import Population
from studyapp.rehearsal.probes import Probe, probe_trial
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.resumption import Roster, call_roster, prepare
from studyapp.rehearsal.server import rehearsal_server
from studyapp.services.database import Database, sqlite_url
from studyapp.services.served_study import ServedStudy

SPEED: Final = 100.0
"""How much faster than real a rehearsal's clock runs."""

WORKERS: Final = 8
"""How many simulated participants take part at the same time."""

STAGGER: Final = 0.05
"""Seconds between the first arrivals."""

REQUEST_SECONDS: Final = 60.0


@dataclass(frozen=True, kw_only=True)
class RehearsalResult:
    """What came of a rehearsal.

    Attributes
    ----------
    completed : int
        Participants who have their completion code, all runs of this rehearsal together.
    kept : int
        How many of them had it before this run.
    probes : tuple of Probe
        Bad submissions that were tried in this run, all of them refused.
    truth : Truth
        What the participants were given to prefer.
    note : str
        What became of an earlier rehearsal in the same folder; empty where there was none.
    seconds : float
        How long it took.
    """

    completed: int
    kept: int
    probes: tuple[Probe, ...]
    truth: Truth
    note: str
    seconds: float


def rehearse(
    folder: StudyFolder,
    *,
    participants: int | None = None,
    seed: int = 1,
    population: Population | None = None,
    speed: float = SPEED,
    workers: int = WORKERS,
    on_done: Callable[[int, int], None] | None = None,
) -> RehearsalResult:
    """Let simulated participants take the study over real HTTP.

    Their answers are kept in ``rehearsal.db``, their true preferences in ``rehearsal.json``.
    Interrupted and called again with the same study and seed, it goes on where it was.

    Parameters
    ----------
    folder : StudyFolder
        A study whose videos are rendered.
    participants : int, optional
        Per comparison; as many as the study asks for by default, and no more than those.
    seed : int
        Decides the participants, what they prefer and every answer.
    population : Population, optional
        Whom to draw them from; `default_population` of the study by default.
    speed : float
        How much faster than real the rehearsal's clock runs; at least 1.
    workers : int
        How many take part at the same time; it changes no answer.
    on_done : callable, optional
        Called with (finished participants, all participants).

    Raises
    ------
    InputError
        If the study is not ready or being rehearsed already, more participants are asked for
        than it has places, a page lacks what a participant needs, or something bad is not
        refused.
    """
    started = time.monotonic()
    study = ServedStudy.read(folder.root).study
    count = _checked_count(folder, study, participants) * len(study.others)
    with only_rehearsal(folder), ExitStack() as opened:
        truth, note = prepare(folder, seed=seed, population=population)
        database = opened.enter_context(closing(Database.open(sqlite_url(folder.rehearsal))))
        roster = call_roster(database, count)
        there = count - len(roster.remaining)
        show = on_done or _show_nothing
        show(there, count)
        probes: tuple[Probe, ...] = ()
        if roster.remaining:
            with rehearsal_server(folder, speed=speed) as server:
                crowd = _Crowd(
                    study=study, truth=truth, eyes=Eyes(database), server=server, speed=speed
                )
                crowd.take_part(
                    roster, workers=workers, on_done=lambda done: show(there + done, count)
                )
                probes = tuple(crowd.probes)
    return RehearsalResult(
        completed=len(roster.finished) + len(roster.remaining),
        kept=len(roster.finished),
        probes=probes,
        truth=truth,
        note=note,
        seconds=time.monotonic() - started,
    )


def _show_nothing(_done: int, _total: int) -> None:
    """Take no notice of progress."""


def _checked_count(folder: StudyFolder, study: Study, participants: int | None) -> int:
    places = study.participants_per_comparison
    if participants is None:
        return places
    if not 1 <= participants <= places:
        raise InputError(
            f"{participants} participants per comparison do not fit into {places} places",
            where=folder.definition,
            remedy="Ask for fewer, or raise participants_per_comparison",
        )
    return participants


@dataclass(frozen=True, kw_only=True)
class _Crowd:
    """The participants of one run, and what they have in common."""

    study: Study
    truth: Truth
    eyes: Eyes
    server: str
    speed: float
    stop: Event = field(default_factory=Event)
    probes: list[Probe] = field(default_factory=list)

    def take_part(self, roster: Roster, *, workers: int, on_done: Callable[[int], None]) -> None:
        """Let the rest of `roster` come, `workers` at a time; the first error stops everybody.

        The first who is new tries bad submissions at the first trial.
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
        participant = Participant(
            entrance=f"/?PROLIFIC_PID={name}&STUDY_ID=rehearsal&SESSION_ID={name}",
            questions=tuple(question.name for question in self.study.questions),
            population=self.truth.population,
            seed=self.truth.seed,
            eyes=self.eyes,
            speed=self.speed,
            stop=self.stop,
            answer_first=self._probe if probing else answer_trial,
        )
        # Certificates are not needed on the loopback, and loading them takes longer than a visit.
        unused = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        with httpx.Client(
            base_url=self.server,
            follow_redirects=True,
            timeout=REQUEST_SECONDS,
            trust_env=False,
            verify=unused,
            headers={"Accept": "text/html"},
        ) as client:
            try:
                participant.take_part(client)
            except httpx.TransportError as error:
                raise InputError(
                    f"the study's server does not answer any more ({error})",
                    where=self.server,
                    remedy="Run the command again: it goes on where it was",
                ) from error

    def _probe(self, visit: Visit, page: Page, answers: dict[str, str]) -> Page:
        gated = self.study.watching.coverage > 0
        following, probes = probe_trial(visit, page, answers, self.eyes, gated=gated)
        self.probes.extend(probes)
        return following
