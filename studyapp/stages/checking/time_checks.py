"""Whether participants are told how long the study really takes, and whether it is too long."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from studyapp.definition.study import Study
from studyapp.stages.checking.expected_time import ExpectedTime
from studyapp.stages.checking.finding import Finding, note, warning
from studyapp.stages.checking.pace import Pace

EXPECTED_DURATION: Final = note(
    "expected-duration", "how long a participant will need, by videos, questions and texts"
)
DURATION_MISSTATED: Final = warning(
    "duration-misstated",
    "participants are told another duration than they will need",
    "Correct page.minutes in study.toml: whoever is told too little is paid too little",
)
DURATION_LONG: Final = warning(
    "duration-long",
    "the study takes so long that people tire and leave",
    "Show fewer trials or shorter segments to more participants",
)
LEASE_SHORT: Final = warning(
    "lease-short",
    "a slow participant's place may be given to somebody else while they work on one page",
    "Raise lease_minutes in study.toml",
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
    yield EXPECTED_DURATION.found(
        f"a participant needs about {needed} minutes: {expected.videos / 60:.1f} of videos watched "
        f"once, {expected.around / 60:.1f} of reading and answering{seen}",
        where="page.minutes",
    )
    told = study.page.minutes
    if told is not None and abs(told - needed) > max(MINUTES_OFF, SHARE_OFF * needed):
        yield DURATION_MISSTATED.found(
            f"page.minutes says {told}, and participants need about {needed}",
            where="page.minutes",
            remedy=f"Set minutes = {needed} under [page] in study.toml, and see what it pays then",
        )
    if needed > LONG_MINUTES:
        yield DURATION_LONG.found(
            f"about {needed} minutes is longer than the {LONG_MINUTES} after which people tire and "
            "leave",
            where="study.toml",
        )
    if study.lease_minutes * 60 < SLOW * expected.longest_page:
        yield LEASE_SHORT.found(
            f"the longest page takes about {expected.longest_page / 60:.0f} minutes, and after "
            f"{study.lease_minutes} minutes of silence the place is given to somebody else",
            where="lease_minutes",
        )
