"""Simulated participants who take part in a study that is served for real, not rehearsed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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


@dataclass(frozen=True, kw_only=True)
class ArrivingCrowd:
    """Attentive participants, each in a thread of their own.

    Attributes
    ----------
    folder : StudyFolder
        What is served.
    server : str
        Where.
    remark : str
        What each writes wherever something may be written freely.
    here : Semaphore
        Released by each who comes to the first trial.
    may_answer : Event
        What they wait for there.
    """

    folder: StudyFolder
    server: str
    remark: str
    eyes: Eyes
    pool: ThreadPoolExecutor
    stop: Event
    at_first_trial: Semaphore = field(default_factory=lambda: Semaphore(0))
    may_answer: Event = field(default_factory=Event)

    def come(self, names: Sequence[str]) -> list[Future[str]]:
        """Let participants come at once; each gives a completion code in the end."""
        return [self.pool.submit(self._take_part, name) for name in names]

    def _take_part(self, name: str) -> str:
        study = self.folder.study()
        participant = _Arriving(
            name=name,
            study=study,
            population=replace(default_population(study), kinds={}),
            seed=7,
            eyes=self.eyes,
            speed=AS_REAL,
            stop=self.stop,
            crowd=self,
        )
        with study_client(self.server) as client:
            return participant.take_part(client)


@dataclass(frozen=True, kw_only=True)
class _Arriving(Participant):
    crowd: ArrivingCrowd

    def answer(self, visit: Visit, page: Page, judgement: Judgement) -> Page:
        """Watch in real time, and think in none."""
        if not self.crowd.may_answer.is_set():
            self.crowd.at_first_trial.release()
            self.crowd.may_answer.wait()
        return super().answer(replace(visit, thinks=0.0), page, judgement)

    def fill(self, visit: Visit, page: Page, answers: FormFields) -> Page:
        """Write the crowd's remark where one is asked for."""
        remark = self.crowd.remark
        texts = {
            name: (remark,) if name.endswith("remarks") else values
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
        crowd = ArrivingCrowd(
            folder=folder,
            server=server,
            remark=remark,
            eyes=Eyes(database),
            pool=pool,
            stop=stop,
        )
        try:
            yield crowd
        finally:
            stop.set()
            crowd.may_answer.set()
            pool.shutdown(cancel_futures=True)
