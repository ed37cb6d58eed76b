"""The eyes and ears of simulated raters: pages are blinded, so their content is looked up."""

from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session, joinedload, selectinload

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial, Video
from studyapp.rehearsal.pages import BrokenPageError, Page, token_candidates
from studyapp.study.design.trial import Stimulus


@dataclass(frozen=True, kw_only=True)
class Sight:
    """A stored trial as its page shows it, and to whom.

    Attributes
    ----------
    rater : str
        Names the rater by its place, whoever holds it: a place's answers are the same in every
        rehearsal with the same seed. Whoever replaces somebody who was excluded, or who left, is
        another rater.
    trials : int
        How many there are in the whole study session.
    """

    rater: str
    trials: int
    position: int
    kind: str
    part: str
    stimuli: tuple[Stimulus, ...]
    expected: int | None
    instructed: int | None

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""
        return tuple(stimulus.condition for stimulus in self.stimuli)


@dataclass(frozen=True)
class Eyes:
    """Looks up the content of a page in the rehearsal's database, without writing."""

    database: Database

    def look(self, page: Page) -> Sight:
        """Return the trial on `page`.

        Raises
        ------
        BrokenPageError
            If its videos are not all those of one trial of this rehearsal.
        """
        tokens = {part for player in page.players for part in token_candidates(player.source)}
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
            held = {video.token for trial in trials for video in trial.videos}
            if len(trials) != 1 or len(held) != len(page.players) or not held <= tokens:
                raise BrokenPageError(
                    page, "does not show the videos of one trial of the rehearsal"
                )
            return read_sight(session, trials[0])

    def hear(self, page: Page) -> str:
        """Return the digits that are spoken to the participant of `page`.

        Raises
        ------
        BrokenPageError
            If no digits are spoken.
        """
        query = select(StudySession.sound_digits).where(
            StudySession.token.in_(token_candidates(page.address))
        )
        with self.database.reading() as session:
            digits = session.scalar(query)
        if not digits:
            raise BrokenPageError(page, "plays sound to a participant without digits")
        return digits


def read_sight(session: Session, trial: Trial) -> Sight:
    """Return what the page of `trial` shows."""
    planned = select(func.count()).where(Trial.study_session_id == trial.study_session_id)
    return Sight(
        rater=rater_name(session, trial.study_session),
        trials=session.scalars(planned).one(),
        position=trial.position,
        kind=trial.kind,
        part=trial.part,
        stimuli=tuple(
            Stimulus(condition=shown.condition, segment=shown.segment, speech=shown.speech)
            for shown in trial.stimuli
            if shown.number > 0
        ),
        expected=trial.expected,
        instructed=trial.instructed,
    )


def rater_name(session: Session, study_session: StudySession) -> str:
    """Return the name of the rater at a place, the first one or a replacement."""
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
