"""How long a study takes, as expected and as observed, and whether participants are told so."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from statistics import median
from typing import Final

from sqlalchemy import select

from studyapp.database.engine import Database, database_url_of
from studyapp.database.tables import StudySession
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.session.trials import expected_seconds
from studyapp.study.design.trial import Content, PlannedTrial, has_sound
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SECONDS_FOR_A_FORM_QUESTION: Final = 8.0
SECONDS_FOR_INSTRUCTIONS: Final = 60.0
SECONDS_FOR_THE_SOUND_CHECK: Final = 25.0
WORDS_A_MINUTE: Final = 200
"""Careful silent reading: adults read 238 words a minute of English (Brysbaert 2019)."""

CHARACTERS_A_WORD: Final = 2.5
"""In languages written without spaces."""

SAMPLED_PLACES: Final = 24
"""Places of each arm whose time is estimated."""


@dataclass(frozen=True, kw_only=True)
class ExpectedTime:
    """The time that a participant needs.

    Attributes
    ----------
    videos : float
        Seconds to watch each video once.
    around : float
        Seconds to read and answer.
    longest_page : float
        Seconds of the longest trial.
    """

    videos: float
    around: float
    longest_page: float

    @property
    def seconds(self) -> float:
        """The sum of both."""
        return self.videos + self.around


def expected_time(material: Material) -> ExpectedTime | None:
    """Return the time of the median participant; None without trials."""
    times = [
        _trials_time(plan, material)
        for _, plans in material.planned
        for plan in plans[:SAMPLED_PLACES]
        if plan
    ]
    if not times:
        return None
    return ExpectedTime(
        videos=median(time.videos for time in times),
        around=median(time.around for time in times) + _entrance_seconds(material),
        longest_page=max(time.longest_page for time in times),
    )


def _trials_time(plan: Sequence[PlannedTrial], material: Material) -> ExpectedTime:
    videos = [[_video_seconds(content, material) for content in trial.shown] for trial in plan]
    pages = [
        expected_seconds(durations, len(material.study.asks(trial)))
        for trial, durations in zip(plan, videos, strict=True)
    ]
    watched = sum(map(sum, videos))
    return ExpectedTime(videos=watched, around=sum(pages) - watched, longest_page=max(pages))


def _entrance_seconds(material: Material) -> float:
    study = material.study
    listens = study.page.sound_check and has_sound(material.contents)
    return (
        SECONDS_FOR_INSTRUCTIONS
        + SECONDS_FOR_A_FORM_QUESTION * len(list(study.form.asked()))
        + 60 * _count_words(study.page.consent) / WORDS_A_MINUTE
        + (SECONDS_FOR_THE_SOUND_CHECK if listens else 0.0)
    )


def _count_words(text: str) -> float:
    """Return the number of words; estimated from characters in text without spaces."""
    spaced, unspaced = re.subn(r"[\u3040-\u30ff\u4e00-\u9fff]", " ", text)
    return len(spaced.split()) + unspaced / CHARACTERS_A_WORD


def _video_seconds(content: Content, material: Material) -> float:
    """Return the length of a video, or of its segment before it is rendered."""
    video = material.shown.get(content)
    return video.duration if video else material.segments_by_name[content[0].segment].duration


FEWEST_FINISHED: Final = 3
"""Below, the pace is down to chance."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """How fast this study's participants were.

    Attributes
    ----------
    finished : int
        Participants who finished.
    minutes : float
        Their median time, as recruiting sites measure it.
    times_expected : float
        The same, relative to the expected time.
    """

    finished: int
    minutes: float
    times_expected: float


def pace_of_study(folder: StudyFolder, expected: ExpectedTime) -> Pace | None:
    """Return the pace of this study's participants; None if too few have finished."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return None
    with closing(database), database.reading() as session:
        # Interruptions count, as they do in the times that recruiting sites report.
        rows = session.execute(
            select(StudySession.consented_at, StudySession.completed_at).where(
                StudySession.completed_at.is_not(None), StudySession.withdrawn_at.is_(None)
            )
        ).all()
    durations = [(ended - began).total_seconds() for began, ended in rows if ended]
    if len(durations) < FEWEST_FINISHED:
        return None
    seconds = median(durations)
    return Pace(
        finished=len(durations),
        minutes=seconds / 60,
        times_expected=seconds / expected.seconds,
    )


LONG_MINUTES: Final = 60

MINUTES_TOLERANCE: Final = 3
SHARE_TOLERANCE: Final = 0.25
"""How far the stated duration may be off, in minutes and as a share of the needed time."""

SLOW_FACTOR: Final = 3.0
"""How many times the expected time a slow participant may spend on a page."""


def minutes_needed(expected: ExpectedTime, pace: Pace | None) -> int:
    """Return the minutes that a participant needs, at the observed pace if there is one."""
    seconds = expected.seconds * (1.0 if pace is None else pace.times_expected)
    return max(1, round(seconds / 60))


def time_findings(study: Study, expected: ExpectedTime, pace: Pace | None) -> Iterator[Finding]:
    """Yield how long the study takes, and settings that do not fit that."""
    needed = minutes_needed(expected, pace)
    observed = (
        f"; the {pace.finished} who have finished took {pace.minutes:.0f} (median), "
        f"{pace.times_expected:.1f} times the expected time"
        if pace
        else ""
    )
    yield make_finding(
        "expected-duration",
        needed=needed,
        videos=expected.videos / 60,
        around=expected.around / 60,
        pace=observed,
    )
    stated = study.page.minutes
    tolerance = max(MINUTES_TOLERANCE, SHARE_TOLERANCE * needed)
    if stated is not None and abs(stated - needed) > tolerance:
        yield make_finding(
            "duration-misstated",
            stated=stated,
            needed=needed,
            remedy=f"Set minutes = {needed} under [page] in study.toml, and check the hourly rate",
        )
    if needed > LONG_MINUTES:
        yield make_finding("duration-long", needed=needed, most=LONG_MINUTES)
    if study.lease_minutes * 60 < SLOW_FACTOR * expected.longest_page:
        yield make_finding(
            "lease-short", page=expected.longest_page / 60, lease=study.lease_minutes
        )
