"""A participant's steps, straight through the services, and a clock for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import select

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.session.answers import skip_unplayable, store_answers
from studyapp.session.ending import withdraw
from studyapp.session.enrolment import Arrival, enrol
from studyapp.session.form_answers import start_trials
from studyapp.session.participation import Situation, load_situation
from studyapp.session.playback import content_to_send, record_watched
from studyapp.session.served_study import ServedStudy
from studyapp.session.trials import ShownTrial
from studyapp.session.versions import open_study
from studyapp.session.watch_evidence import Playback, Report, Watched
from tests.support.studies.stored import opened

Result = TypeVar("Result")
ANSWERS = {"rhythm": "1", "emotion": "-2"}

AS_RECORDED = Playback()


@dataclass(frozen=True, kw_only=True)
class SetClock(Clock):
    """A clock that stands still until a test moves it."""

    moments: list[datetime] = field(default_factory=lambda: [datetime(2026, 5, 4, tzinfo=UTC)])

    def now(self) -> datetime:
        return self.moments[-1]

    def advance(self, **duration: float) -> None:
        self.moments.append(self.moments[-1] + timedelta(**duration))


@dataclass
class Participant:
    """One participant of `served` on a clock that the test moves."""

    database: Database
    served: ServedStudy
    clock: SetClock
    token: str = ""

    def another(self) -> Participant:
        """Return a participant who has not arrived yet."""
        return Participant(self.database, self.served, self.clock)

    def enrol(self, name: str = "visit") -> Participant:
        return self.arrive(Arrival(visit=name))

    def arrive(self, arrival: Arrival) -> Participant:
        """Take part as whoever `arrival` says."""
        self.token = enrol(self.database, self.served, arrival, self.clock)
        return self

    def in_study(self, served: ServedStudy, *, new_version: bool = False) -> Participant:
        """Open `served` on the same database; return this participant, who takes part in it."""
        open_study(self.database, served, self.clock, new_version=new_version)
        return replace(self, served=served)

    def withdraw(self) -> None:
        withdraw(self.database, self.token, self.clock)

    def stored(self) -> StudySession:
        with self.database.reading() as session:
            return session.scalars(
                select(StudySession).where(StudySession.token == self.token)
            ).one()

    def do(self, service: Callable[..., Result], *asked: Any, **more: Any) -> Result:
        """Ask a service in this participant's name."""
        return service(self.database, self.served, self.token, *asked, clock=self.clock, **more)

    def begin(self, *, tries: int = 0, **answers: str) -> Participant:
        self.do(start_trials, answers=answers, tries=tries)
        return self

    def look(self) -> Situation:
        return self.do(load_situation)

    def trial(self) -> ShownTrial:
        shown = self.look().trial
        assert shown is not None
        return shown

    def fetch(self, video_token: str) -> None:
        """Let the server send a video."""
        content_to_send(self.database, video_token, self.clock)

    def leave_out(self, media_error: str = "4") -> None:
        """Report that the first video of the current trial does not play."""
        trial = self.trial()
        self.fetch(trial.videos[0].token)
        video = trial.videos[0].token
        self.do(skip_unplayable, trial.token, video_token=video, media_error=media_error)

    def report(
        self,
        video_token: str,
        *intervals: tuple[float, float],
        batch: int = 0,
        playback: Playback = AS_RECORDED,
    ) -> Watched:
        """Tell the server that a video was played, whether it was sent or not."""
        report = Report(batch=batch, intervals=intervals, **vars(playback))
        return self.do(record_watched, video_token, report)

    def watch(
        self, *intervals: tuple[float, float], batch: int = 0, playback: Playback = AS_RECORDED
    ) -> float:
        video = self.trial().videos[0].token
        self.fetch(video)
        return self.report(video, *intervals, batch=batch, playback=playback).missing

    def answer(self, trial_token: str, answers: Mapping[str, str | list[str]] = ANSWERS) -> None:
        fields = {
            name: [value] if isinstance(value, str) else value for name, value in answers.items()
        }
        self.do(store_answers, trial_token, fields)

    def watch_all(self) -> ShownTrial:
        """Play every video of the present trial to its end, one after the other."""
        shown = self.trial()
        self.clock.advance(seconds=3 * len(shown.videos))
        for video in shown.videos:
            self.fetch(video.token)
            self.report(video.token, (0.0, video.duration))
        return shown

    def take_trial(self, answers: Mapping[str, str | list[str]] = ANSWERS) -> str:
        trial_token = self.trial().token
        self.clock.advance(seconds=5)
        self.watch((0.0, 2.0))
        self.answer(trial_token, answers)
        return trial_token

    def take_all(self) -> str:
        while self.look().trial is not None:
            self.take_trial()
        code = self.look().completion_code
        assert code is not None
        return code


@contextmanager
def taking_part(folder: Path, file: str = "responses.db") -> Iterator[Participant]:
    """Give a participant who has not arrived yet at the study in `folder`, with answers in
    `file`."""
    with opened(folder / file) as database:
        participant = Participant(database, ServedStudy.read(folder), SetClock())
        open_study(database, participant.served, participant.clock)
        yield participant
