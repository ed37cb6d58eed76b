"""The eyes and ears of simulated raters: pages are blinded, so what they show is looked up."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session, joinedload, selectinload

from studyapp.database.engine import Database
from studyapp.database.tables import StudySession, Trial, Video
from studyapp.rehearsal.pages import BrokenPageError, Page, token_candidates
from studyapp.rehearsal.simulation.raters import SeenTrial, Sight
from studyapp.study.design.trial import Stimulus


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
            study_session = trial.study_session
            planned = select(func.count()).where(Trial.study_session_id == study_session.id)
            return Sight(
                rater=rater_name(session, study_session),
                trial=seen(trial),
                trials=session.scalars(planned).one(),
            )

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


def rater_name(session: Session, study_session: StudySession) -> str:
    """Return the name of the rater that holds a place, as the first one or as a later one."""
    earlier = session.scalar(
        select(func.count())
        .select_from(StudySession)
        .where(
            StudySession.arm == study_session.arm,
            StudySession.arm_design == study_session.arm_design,
            StudySession.number == study_session.number,
            StudySession.id < study_session.id,
        )
    )
    place = f"{study_session.arm} {study_session.number}"
    return f"{place} again {earlier}" if earlier else place


def _tokens(page: Page) -> frozenset[str]:
    return frozenset(part for player in page.players for part in player.token_candidates)
