"""The eyes of simulated raters: pages are blinded, so what they show is looked up."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import joinedload, selectinload

from studyapp.models import Response, StudySession, Trial, Video
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.raters import ShownPair
from studyapp.services.database import Database


@dataclass(frozen=True, kw_only=True)
class Sight:
    """What a page shows, and to whom.

    Attributes
    ----------
    rater : str
        Names the rater by its place, whoever holds it: a place's answers are the same in every
        rehearsal with the same seed.
    pair : ShownPair
        What is to be judged.
    """

    rater: str
    pair: ShownPair


@dataclass(frozen=True)
class Eyes:
    """Looks up what a page shows in the rehearsal's own database; it never writes."""

    database: Database

    def look(self, page: Page) -> Sight:
        """Return what the pair on `page` shows.

        Raises
        ------
        BrokenPageError
            If its video's address holds no media token of this rehearsal.
        """
        query = (
            select(Trial)
            .join(Trial.videos)
            .where(Video.token.in_(page.player().token_candidates))
            .options(
                joinedload(Trial.study_session).joinedload(StudySession.place),
                selectinload(Trial.stimuli),
            )
        )
        with self.database.reading() as session:
            trial = session.scalars(query).one_or_none()
        if trial is None:
            raise BrokenPageError(page, "shows a video that is no trial of this rehearsal")
        sitting = trial.study_session
        place = "no place" if sitting.place is None else str(sitting.place.number)
        left, right = trial.conditions
        return Sight(
            rater=f"{sitting.arm} {place}",
            pair=ShownPair(
                position=trial.position,
                segment=trial.segment,
                left=left,
                right=right,
                instructed=trial.instructed,
            ),
        )

    def stored(self, page: Page) -> tuple[tuple[int, str, int], ...]:
        """Return the answers of the participant who sees `page`: position, question, value."""
        tokens = page.player().token_candidates
        sitting = select(Trial.study_session_id).join(Trial.videos).where(Video.token.in_(tokens))
        query = (
            select(Trial.position, Response.question, Response.value)
            .join(Response.trial)
            .where(Trial.study_session_id.in_(sitting.scalar_subquery()))
            .order_by(Trial.position, Response.question)
        )
        with self.database.reading() as session:
            return tuple((row.position, row.question, row.value) for row in session.execute(query))
