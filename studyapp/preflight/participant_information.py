"""What participants are told before they agree, and how long the study really takes."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Final, get_args

from sqlalchemy import select

from motion.errors import InputError
from motion.listing import listed
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.database.tables import StudySession
from studyapp.preflight.expected_time import ExpectedTime, expected_time
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.study.creation.template_language import still_english, template_text
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.page import Language, reaches_somebody
from studyapp.study.settings.study import Study


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


def page_findings(study: Study) -> Iterator[Finding]:
    """Say what participants are not told, and what still says what a template says."""
    page = study.page
    for given, name in (
        (page.organisation, "organisation-missing"),
        (page.contact, "contact-missing"),
        (page.payment, "payment-missing"),
        (page.minutes, "minutes-missing"),
        (page.ethics, "ethics-missing"),
    ):
        if not given or not str(given).strip():
            yield finding(name)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield finding("contact-unreachable", contact=page.contact)
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    consents, titles = _template_texts(study)
    if not study.page.consent.strip():
        yield finding("consent-blank")
    elif _squeezed(study.page.consent) in consents:
        yield finding("consent-from-template")
    if _squeezed(study.title) in titles:
        yield finding("title-from-template", title=study.title)
    english = still_english(study)
    if english:
        yield finding("texts-untranslated", language=study.page.language, texts=listed(english))


def _template_texts(study: Study) -> tuple[set[str], set[str]]:
    """Return the consent texts and the titles that templates of the protocol have."""
    file = f"{study.protocol}.toml"
    consents, titles = set(), set()
    for language in get_args(Language):
        source = tomllib.loads(template_text(file, language))
        consents.add(_squeezed(source["page"]["consent"]))
        titles.add(_squeezed(source["title"]))
    return consents, titles


def _squeezed(text: str) -> str:
    """Return a text in which white space says nothing."""
    return " ".join(text.split())
