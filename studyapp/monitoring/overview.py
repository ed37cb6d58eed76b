"""All that the overview of a running study shows, read from one state of the database."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from studyapp.database.engine import Database
from studyapp.monitoring.answered_trials import (
    Progress,
    Sides,
    Times,
    answered_trials,
    progress,
    shown_on_sides,
    sides,
    times,
    times_of_trials,
)
from studyapp.monitoring.counts import (
    Completions,
    Dropouts,
    Forecast,
    PlaceCounts,
    all_together,
    completions,
    count_places,
    dropouts,
    forecast,
)
from studyapp.monitoring.data_quality import (
    CheckedItem,
    PlayedVideo,
    checked_items,
    checks,
    failed_by_session,
    played_videos,
)
from studyapp.monitoring.decisions import Decision, decisions
from studyapp.monitoring.study_sessions import SessionProgress, present_ones, progress_of_sessions
from studyapp.session.ending import JUDGED
from studyapp.session.intake import Intake, present_intake
from studyapp.session.served_study import ServedStudy

KINDS: Final = ("practice", "main", "repeat", *JUDGED)
MOST_LISTED: Final = 20
"""People who are named where there may be very many."""


@dataclass(frozen=True, kw_only=True)
class FailedChecks:
    """How many failed how many checks of one kind.

    Attributes
    ----------
    by_failures : tuple of (int, int)
        A number of failed checks, and how many participants failed so many.
    """

    kind: str
    by_failures: tuple[tuple[int, int], ...]


@dataclass(frozen=True, kw_only=True)
class Overview:
    """How the study goes, at one moment.

    Attributes
    ----------
    at : datetime
    intake : Intake
        Whether newcomers are let in, as far as the study file lets them.
    places, arms : PlaceCounts, tuple of PlaceCounts
        Of all arms together, and of each.
    completions : Completions or None
        Places done over time; None where none is.
    earlier : int
        Study sessions of earlier versions of the study, which are counted nowhere else.
    lapsed, replaced, unwatched : int
        Study sessions that hold no place.
    excluded : int
        Study sessions that researchers leave out of the analysis; most hold places all the same.
    leaving_out : tuple of SessionProgress
        Who said most often that a video does not play; nobody who never did.
    whole : Times
        How long whole study sessions take, from the first trial to the last answer.
    """

    at: datetime
    intake: Intake
    places: PlaceCounts
    arms: tuple[PlaceCounts, ...]
    forecast: Forecast
    completions: Completions | None
    earlier: int
    lapsed: int
    replaced: int
    unwatched: int
    excluded: int
    leaving_out: tuple[SessionProgress, ...]
    progress: Progress
    dropouts: Dropouts
    failed: tuple[FailedChecks, ...]
    items: tuple[CheckedItem, ...]
    whole: Times
    trials: tuple[Times, ...]
    videos: tuple[PlayedVideo, ...]
    sides: tuple[Sides, ...]
    decisions: tuple[Decision, ...]


def overview(database: Database, served: ServedStudy, now: datetime) -> Overview:
    """Return how the study goes."""
    with database.reading() as session:
        everybody = progress_of_sessions(session, served, now)
        present = present_ones(everybody)
        counted = {each.id: each.arm for each in present if each.standing != "withdrawn"}
        trials = [each for each in answered_trials(session) if each.study_session in counted]
        names = served.study.display_names
        found = checks(session, served.study, counted)
        videos = played_videos(session, names)
        balance = sides(shown_on_sides(session), names)
        intake = present_intake(session)
    arms = count_places(served.study.arms, present, intake.more_places)
    places, left, items = all_together(arms), dropouts(present), checked_items(found)
    whole = times("whole study session", _whole_seconds(present))
    began = min((each.consented_at for each in present), default=None)
    expected = _forecast(present, places, began, now)
    done = [each.completed_at for each in present if each.standing == "done" and each.completed_at]
    return Overview(
        at=now,
        intake=intake,
        places=places,
        arms=arms,
        forecast=expected,
        completions=completions(done, places.wanted, began, expected.at, now),
        earlier=len(everybody) - len(present),
        lapsed=sum(each.standing == "lapsed" for each in present),
        replaced=sum(each.standing == "replaced" for each in present),
        unwatched=sum(each.standing == "unwatched" for each in present),
        leaving_out=_leaving_out(present),
        excluded=sum(each.excluded for each in present),
        progress=progress(trials, counted),
        dropouts=left,
        failed=tuple(
            FailedChecks(kind=kind, by_failures=_tally(failed_by_session(found, kind).values()))
            for kind in JUDGED
            if any(check.kind == kind for check in found)
        ),
        items=items,
        whole=whole,
        trials=times_of_trials(trials, KINDS),
        videos=videos,
        sides=balance,
        decisions=decisions(
            places=places,
            open_to_newcomers=served.study.open and intake.state == "open",
            videos=videos,
            items=items,
            sides=balance,
            left=left,
            whole=whole,
            minutes_said=served.study.page.minutes,
        ),
    )


def places_so_far(database: Database, served: ServedStudy, now: datetime) -> PlaceCounts:
    """Return how many places are done, active, stale and open, of all arms together."""
    with database.reading() as session:
        present = present_ones(progress_of_sessions(session, served, now))
        more = present_intake(session).more_places
    return all_together(count_places(served.study.arms, present, more))


def _forecast(
    present: Sequence[SessionProgress], places: PlaceCounts, began: datetime | None, now: datetime
) -> Forecast:
    finished = [each.completed_at for each in present if each.completed_at is not None]
    return forecast(finished, places.still_to_be_done, began, now)


def _leaving_out(present: Sequence[SessionProgress]) -> tuple[SessionProgress, ...]:
    some = [each for each in present if each.left_out]
    return tuple(sorted(some, key=lambda each: -each.left_out)[:MOST_LISTED])


def _whole_seconds(present: Sequence[SessionProgress]) -> list[float]:
    return [
        (each.completed_at - each.started_at).total_seconds()
        for each in present
        if each.completed_at is not None and each.started_at is not None
    ]


def _tally(failures: Iterable[int]) -> tuple[tuple[int, int], ...]:
    return tuple(sorted(Counter(failures).items()))
