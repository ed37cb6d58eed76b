"""How long a study takes, expected and by who took it, and whether participants are told so."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Final

from sqlalchemy import select

from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.database.tables import StudySession
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.session.shown_trials import expected_seconds
from studyapp.study.design.trial import Content, PlannedTrial
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SECONDS_FOR_A_FORM_QUESTION: Final = 8.0
SECONDS_FOR_INSTRUCTIONS: Final = 60.0
SECONDS_FOR_THE_SOUND_CHECK: Final = 25.0
WORDS_A_MINUTE: Final = 200
"""Careful silent reading: adults read 238 words a minute of English (Brysbaert 2019)."""

CHARACTERS_A_WORD: Final = 2.5
"""Of languages that write no spaces."""

PLACES: Final = 24
"""Places of each arm whose time is reckoned."""


@dataclass(frozen=True, kw_only=True)
class ExpectedTime:
    """What a participant needs.

    Attributes
    ----------
    videos : float
        Seconds of watching each video once.
    around : float
        Seconds of reading and answering.
    longest_page : float
        Seconds of the longest trial.
    """

    videos: float
    around: float
    longest_page: float

    @property
    def seconds(self) -> float:
        """All of it."""
        return self.videos + self.around


def expected_time(material: Material) -> ExpectedTime | None:
    """Return what the middle participant needs; None where there is no trial."""
    study = material.study
    known = [
        time
        for _, plans in material.planned
        for plan in plans[:PLACES]
        if (time := _of_plan(plan, material)) is not None
    ]
    if not known:
        return None
    return ExpectedTime(
        videos=median(time.videos for time in known),
        around=median(time.around for time in known) + _entrance_seconds(study, material),
        longest_page=max(time.longest_page for time in known),
    )


def _of_plan(plan: Sequence[PlannedTrial], material: Material) -> ExpectedTime | None:
    if not plan:
        return None
    videos = [[_lasts(content, material) for content in trial.shown] for trial in plan]
    pages = [
        expected_seconds(durations, len(material.study.asks(trial)))
        for trial, durations in zip(plan, videos, strict=True)
    ]
    watched = sum(map(sum, videos))
    return ExpectedTime(videos=watched, around=sum(pages) - watched, longest_page=max(pages))


def _entrance_seconds(study: Study, material: Material) -> float:
    questions = sum(len(study.form.questions_at(stage)) for stage in study.form.stages())
    heard = any(shown.speech is not None for content in material.contents for shown in content)
    return (
        SECONDS_FOR_INSTRUCTIONS
        + SECONDS_FOR_A_FORM_QUESTION * questions
        + 60 * words(study.page.consent) / WORDS_A_MINUTE
        + (SECONDS_FOR_THE_SOUND_CHECK if study.page.sound_check and heard else 0.0)
    )


def words(text: str) -> float:
    """Return how many words a text has; without spaces, as many as it would have."""
    unspaced = len(re.findall(r"[\u3040-\u30ff\u4e00-\u9fff]", text))
    spaced = len(re.sub(r"[\u3040-\u30ff\u4e00-\u9fff]", " ", text).split())
    return spaced + unspaced / CHARACTERS_A_WORD


def _lasts(content: Content, material: Material) -> float:
    """Return how long a video lasts, or will last once it is rendered."""
    video = material.shown.get(content)
    return video.duration if video else material.by_name[content[0].segment].duration


def finished_seconds(database: Database) -> tuple[float, ...]:
    """Return the seconds from agreeing to the end, of who finished and did not withdraw.

    Interruptions are in it, as they are in what recruiting sites measure.
    """
    with database.reading() as session:
        rows = session.execute(
            select(StudySession.consented_at, StudySession.completed_at)
            .where(StudySession.completed_at.is_not(None), StudySession.withdrawn_at.is_(None))
            .order_by(StudySession.id)
        ).all()
    return tuple((ended - began).total_seconds() for began, ended in rows if ended is not None)


def arrivals(database: Database) -> int:
    """Return how many have begun to take part."""
    with database.reading() as session:
        return len(session.scalars(select(StudySession.id)).all())


FEWEST: Final = 3
"""With fewer who have finished, their pace is chance."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """What those tell who have finished.

    Attributes
    ----------
    finished : int
    minutes : float
        The median of what they took, as recruiting sites reckon.
    times_expected : float
        The same by what was expected of the study that they took.
    source : str
        Whose it is, in words.
    """

    finished: int
    minutes: float
    times_expected: float
    source: str


def pace_of_study(material: Material) -> Pace | None:
    """Return the pace of who has finished this study; None where that tells nothing."""
    return _pace(material, database_url_of(material.folder.root), "this study")


def pace_of_pilot(folder: StudyFolder) -> Pace:
    """Return the pace of who has finished a pilot.

    Raises
    ------
    InputError
        If it cannot be read, or too few have finished it.
    """
    pilot = Material.of(folder, folder.study())
    found = _pace(pilot, sqlite_url(folder.responses), f"the pilot {folder.root.name}")
    if found is None:
        raise InputError(
            f"fewer than {FEWEST} participants have finished the pilot, so that it tells no pace",
            where=folder.responses,
            remedy="Name a study that people have taken, or leave --pilot away",
        )
    return found


def _pace(material: Material, url: str, source: str) -> Pace | None:
    expected = expected_time(material)
    database = Database.open_for_reading(url)
    if database is None or expected is None:
        return None
    try:
        took = finished_seconds(database)
    finally:
        database.close()
    if len(took) < FEWEST:
        return None
    middle = median(took)
    return Pace(
        finished=len(took),
        minutes=middle / 60,
        times_expected=middle / expected.seconds,
        source=source,
    )


LONG_MINUTES: Final = 60

MINUTES_OFF: Final = 3
SHARE_OFF: Final = 0.25
"""What is told may be wrong by so many minutes, and by so much of what is needed."""

SLOW: Final = 3.0
"""Times as long as expected that a slow participant may stay on a page."""


def minutes_needed(expected: ExpectedTime, pace: Pace | None) -> int:
    """Return how many minutes a participant needs, at the pace that was seen, if any was."""
    seconds = expected.seconds * (1.0 if pace is None else pace.times_expected)
    return max(1, round(seconds / 60))


def time_findings(study: Study, expected: ExpectedTime, pace: Pace | None) -> Iterator[Finding]:
    """Say how long the study takes, and what does not fit to that."""
    needed = minutes_needed(expected, pace)
    seen = (
        f"; the {pace.finished} who have finished {pace.source} took {pace.minutes:.0f} (median), "
        f"{pace.times_expected:.1f} times as long as expected of it"
        if pace
        else ""
    )
    yield finding(
        "expected-duration",
        needed=needed,
        videos=expected.videos / 60,
        around=expected.around / 60,
        seen=seen,
    )
    told = study.page.minutes
    if told is not None and abs(told - needed) > max(MINUTES_OFF, SHARE_OFF * needed):
        yield finding(
            "duration-misstated",
            told=told,
            needed=needed,
            remedy=f"Set minutes = {needed} under [page] in study.toml, and see what it pays then",
        )
    if needed > LONG_MINUTES:
        yield finding("duration-long", needed=needed, most=LONG_MINUTES)
    if study.lease_minutes * 60 < SLOW * expected.longest_page:
        yield finding("lease-short", page=expected.longest_page / 60, lease=study.lease_minutes)
