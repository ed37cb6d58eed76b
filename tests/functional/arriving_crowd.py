"""Simulated participants who take part in a study that is served for real, not rehearsed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Event, Semaphore

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.forms import FormFields
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.simulation.judgement import Judgement
from studyapp.rehearsal.simulation.population import default_population
from studyapp.rehearsal.visit import Visit, study_client
from studyapp.study.folder import StudyFolder
from tests.support.studies.stored import opened

AS_REAL = 1.0
"""How fast the clock runs of a study that is not rehearsed."""


@dataclass(frozen=True)
class ArrivingCrowd:
    """Attentive participants, each in a thread of their own.

    Attributes
    ----------
    come : callable
        Lets participants of these names come at once; each gives a completion code in the end.
    at_first_trial : Semaphore
        Released by each who comes to the first trial.
    may_answer : Event
        What they wait for there.
    """

    come: Callable[[Sequence[str]], list[Future[str]]]
    at_first_trial: Semaphore
    may_answer: Event


@dataclass(frozen=True, kw_only=True)
class _Arriving(Participant):
    remark: str
    at_first_trial: Semaphore = field(default_factory=lambda: Semaphore(0))
    may_answer: Event = field(default_factory=Event)

    def answer(self, visit: Visit, page: Page, judgement: Judgement) -> Page:
        """Watch in real time, and think in none."""
        if not self.may_answer.is_set():
            self.at_first_trial.release()
            self.may_answer.wait()
        return super().answer(replace(visit, thinks=0.0), page, judgement)

    def fill(self, visit: Visit, page: Page, answers: FormFields) -> Page:
        """Write the remark where one is asked for."""
        texts = {
            name: (self.remark,) if name.endswith("remarks") else values
            for name, values in answers.items()
        }
        return super().fill(visit, page, texts)


@contextmanager
def arriving_crowd(
    study: Path, server: str, *, at_once: int, remark: str
) -> Iterator[ArrivingCrowd]:
    """Give a crowd for the study at the address `server`; whoever is left is sent away."""
    folder, stop = StudyFolder(study), Event()
    with (
        opened(folder.responses) as database,
        ThreadPoolExecutor(at_once, thread_name_prefix="participant") as pool,
    ):
        first = _Arriving(
            name="",
            study=folder.study(),
            population=replace(default_population(folder.study()), kinds={}),
            seed=7,
            eyes=Eyes(database),
            speed=AS_REAL,
            stop=stop,
            remark=remark,
        )

        def take_part(name: str) -> str:
            with study_client(server) as client:
                return replace(first, name=name).take_part(client)

        try:
            yield ArrivingCrowd(
                lambda names: [pool.submit(take_part, name) for name in names],
                first.at_first_trial,
                first.may_answer,
            )
        finally:
            stop.set()
            first.may_answer.set()
            pool.shutdown(cancel_futures=True)
