"""The eyes and ears of simulated raters: pages are blinded, so what they show is looked up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session, joinedload, selectinload

from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, Response, StudySession, Trial, Video, WatchRecord
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.players import token_candidates
from studyapp.rehearsal.simulation.sight import SeenTrial, Sight
from studyapp.study.design.asking import AnswerKey, Answers
from studyapp.study.design.stimulus import Stimulus


@dataclass(frozen=True, kw_only=True)
class FinishedSitting:
    """A study session that is over, and its last answered trial.

    Attributes
    ----------
    token : str
        Of the study session.
    trial, video : str
        Tokens of the trial, and of its first video.
    seen : SeenTrial
        What it showed.
    values : Answers
        What was answered.
    reasons : mapping of AnswerKey to tuple of str
        What was ticked beside it.
    """

    token: str
    trial: str
    video: str
    seen: SeenTrial
    values: Answers
    reasons: Mapping[AnswerKey, tuple[str, ...]]


StoredAnswer = tuple[int, str, int | None, int, tuple[str, ...]]
"""Position, question, stimulus, value and reasons."""


@dataclass(frozen=True)
class Eyes:
    """Looks up what a page shows in the rehearsal's own database; it never writes."""

    database: Database

    def look(self, page: Page) -> Sight:
        """Return what the trial on `page` shows.

        Raises
        ------
        BrokenPageError
            If the addresses of its videos hold no media token of this rehearsal, or those of
            several trials, or a video of the trial is missing.
        """
        tokens = _tokens(page)
        query = (
            select(Trial)
            .join(Trial.videos)
            .where(Video.token.in_(tokens))
            .distinct()
            .options(
                joinedload(Trial.study_session),
                selectinload(Trial.stimuli),
                selectinload(Trial.videos),
            )
        )
        with self.database.reading() as session:
            trials = session.scalars(query).all()
            if not trials:
                raise BrokenPageError(page, "shows a video that is no trial of this rehearsal")
            if len(trials) > 1:
                raise BrokenPageError(page, "shows videos of several trials")
            (trial,) = trials
            there, wanted = len(page.players), len(trial.videos)
            if there != wanted or not {video.token for video in trial.videos} <= tokens:
                raise BrokenPageError(page, f"shows {there} videos, not the {wanted} of its trial")
            sitting = trial.study_session
            planned = select(func.count()).where(Trial.study_session_id == sitting.id)
            return Sight(
                rater=rater_name(session, sitting),
                trial=seen(trial),
                trials=session.scalars(planned).one(),
            )

    def later_trials(self, page: Page) -> tuple[str, ...]:
        """Return the tokens of the trials that come after the one on `page`, the next one first."""
        shown = select(Trial).join(Trial.videos).where(Video.token.in_(_tokens(page))).distinct()
        with self.database.reading() as session:
            (trial,) = session.scalars(shown).all()
            later = select(Trial.token).where(
                Trial.study_session_id == trial.study_session_id, Trial.position > trial.position
            )
            return tuple(session.scalars(later.order_by(Trial.position)))

    def stored(self, page: Page) -> tuple[StoredAnswer, ...]:
        """Return all answers of the participant who sees `page`."""
        sitting = (
            select(Trial.study_session_id).join(Trial.videos).where(Video.token.in_(_tokens(page)))
        )
        query = (
            select(
                Trial.position,
                Response.question,
                Response.stimulus,
                Response.value,
                Response.reasons,
            )
            .join(Response.trial)
            .where(Trial.study_session_id.in_(sitting))
            .order_by(Trial.position, Response.question, Response.stimulus)
        )
        with self.database.reading() as session:
            return tuple(
                (row.position, row.question, row.stimulus, row.value, tuple(row.reasons))
                for row in session.execute(query)
            )

    def finished(self) -> tuple[FinishedSitting, ...]:
        """Return what finished participants have answered last, the first to finish first."""
        query = (
            select(StudySession)
            .where(StudySession.completed_at.is_not(None))
            .order_by(StudySession.completed_at, StudySession.id)
            .options(
                selectinload(StudySession.trials).selectinload(Trial.responses),
                selectinload(StudySession.trials).selectinload(Trial.stimuli),
                selectinload(StudySession.trials).selectinload(Trial.videos),
            )
        )
        with self.database.reading() as session:
            return tuple(
                FinishedSitting(
                    token=sitting.token,
                    trial=last.token,
                    seen=seen(last),
                    video=last.videos[0].token,
                    values={(r.question, r.stimulus): r.value for r in last.responses},
                    reasons={(r.question, r.stimulus): tuple(r.reasons) for r in last.responses},
                )
                for sitting in session.scalars(query)
                for last in [trial for trial in sitting.trials if trial.responses][-1:]
            )

    def everything(self) -> tuple[object, ...]:
        """Return all that is stored of everybody, as far as a submission could change it."""
        queries = (
            select(Response.trial_id, Response.question, Response.stimulus, Response.value),
            select(StudySession.id, StudySession.completed_at, StudySession.withdrawn_at),
            select(Trial.id, Trial.answered_at, Trial.unplayable_at),
            select(WatchRecord.video_id, WatchRecord.latest),
            select(FormAnswer.study_session_id, FormAnswer.question),
        )
        with self.database.reading() as session:
            return tuple(
                sorted((tuple(row) for row in session.execute(query)), key=repr)
                for query in queries
            )

    def told(self, name: str) -> tuple[int, int]:
        """Return how many study sessions and answers about themselves `name` has stored."""
        sittings = (
            select(func.count())
            .select_from(StudySession)
            .where(StudySession.recruiter_participant == name)
        )
        answers = (
            select(func.count())
            .select_from(FormAnswer)
            .join(FormAnswer.study_session)
            .where(StudySession.recruiter_participant == name)
        )
        with self.database.reading() as session:
            return session.scalar(sittings) or 0, session.scalar(answers) or 0

    def hear(self, page: Page) -> str:
        """Return the digits that are spoken to the participant whose page `page` is.

        Raises
        ------
        BrokenPageError
            If nothing is spoken to them.
        """
        query = select(StudySession.sound_digits).where(
            StudySession.token.in_(token_candidates(page.address))
        )
        with self.database.reading() as session:
            digits = session.scalar(query)
        if not digits:
            raise BrokenPageError(page, "plays sound to a participant for whom there is none")
        return digits


def seen(trial: Trial) -> SeenTrial:
    """Return what eyes that see through the blinding see of `trial`."""
    return SeenTrial(
        position=trial.position,
        kind=trial.kind,
        part=trial.part,
        segment=trial.segment,
        stimuli=tuple(
            Stimulus(condition=shown.condition, segment=shown.segment, speech=shown.speech)
            for shown in trial.stimuli
            if shown.number > 0
        ),
        expected=trial.expected,
        instructed=trial.instructed,
    )


def rater_name(session: Session, sitting: StudySession) -> str:
    """Return the name of the rater that holds a place, as the first one or as a later one."""
    earlier = session.scalar(
        select(func.count())
        .select_from(StudySession)
        .where(
            StudySession.arm == sitting.arm,
            StudySession.arm_design == sitting.arm_design,
            StudySession.number == sitting.number,
            StudySession.id < sitting.id,
        )
    )
    place = f"{sitting.arm} {sitting.number}"
    return f"{place} again {earlier}" if earlier else place


def _tokens(page: Page) -> frozenset[str]:
    return frozenset(part for player in page.players for part in player.token_candidates)
