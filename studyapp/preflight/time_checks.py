"""How long a study takes, and whether participants are told so."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Final

from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.session.trials import expected_seconds
from studyapp.study.design.trial import Content, PlannedTrial, has_sound
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


LONG_MINUTES: Final = 60

MINUTES_TOLERANCE: Final = 3
SHARE_TOLERANCE: Final = 0.25
"""How far the stated duration may be off, in minutes and as a share of the needed time."""

SLOW_FACTOR: Final = 3.0
"""How many times the expected time a slow participant may spend on a page."""


def minutes_needed(expected: ExpectedTime) -> int:
    """Return the minutes that a participant needs."""
    return max(1, round(expected.seconds / 60))


def time_findings(study: Study, expected: ExpectedTime) -> Iterator[Finding]:
    """Yield how long the study takes, and settings that do not fit that."""
    needed = minutes_needed(expected)
    yield make_finding(
        "expected-duration",
        needed=needed,
        videos=expected.videos / 60,
        around=expected.around / 60,
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
