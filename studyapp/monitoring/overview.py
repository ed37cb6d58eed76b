"""The overview of a running study, read from one state of the database."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from studyapp.database.engine import Database
from studyapp.monitoring.answered_trials import (
    Durations,
    Progress,
    Sides,
    answered_trials,
    durations,
    progress,
    sides,
    trial_durations,
)
from studyapp.monitoring.counts import (
    Completions,
    Dropouts,
    Forecast,
    PlaceCounts,
    completions,
    count_places,
    dropouts,
    forecast,
    total_places,
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
from studyapp.monitoring.study_sessions import (
    SessionProgress,
    progress_of_sessions,
)
from studyapp.session.ending import JUDGED
from studyapp.session.form_answers import count_screened_out
from studyapp.session.intake import Intake, current_intake
from studyapp.session.served_study import ServedStudy

KINDS: Final = ("practice", "main", "repeat", *JUDGED)
MOST_LISTED: Final = 20
"""Rows of a list that may be very long."""


@dataclass(frozen=True, kw_only=True)
class FailedChecks:
    """How many participants failed how many checks of one kind.

    Attributes
    ----------
    by_failures : tuple of (int, int)
        Numbers of failed checks, each with how many participants failed so many.
    """

    kind: str
    by_failures: tuple[tuple[int, int], ...]


@dataclass(frozen=True, kw_only=True)
class Overview:
    """The study's progress at one moment.

    Attributes
    ----------
    at : datetime
    intake : Intake
        Whether newcomers are admitted, as far as the study file allows it.
    places, arms : PlaceCounts, tuple of PlaceCounts
        Of all arms together, and of each.
    completions : Completions or None
        Places done over time; None if none is.
    earlier : int
        Study sessions of earlier versions of the study, which are counted nowhere else.
    lapsed, replaced, unwatched : int
        Study sessions that hold no place.
    screened_out : mapping of str to int
        How many were screened out at each stage, in all versions of the study.
    excluded : int
        Study sessions that researchers exclude from the analysis; most hold places all the same.
    leaving_out : tuple of SessionProgress
        Participants who most often said that a video does not play, if at all.
    whole : Durations
        Of whole study sessions, from the first trial to the last answer.
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
    screened_out: Mapping[str, int]
    excluded: int
    leaving_out: tuple[SessionProgress, ...]
    progress: Progress
    dropouts: Dropouts
    failed: tuple[FailedChecks, ...]
    items: tuple[CheckedItem, ...]
    whole: Durations
    trials: tuple[Durations, ...]
    videos: tuple[PlayedVideo, ...]
    sides: tuple[Sides, ...]
    decisions: tuple[Decision, ...]


def overview(database: Database, served: ServedStudy, now: datetime) -> Overview:
    """Return the study's progress."""
    with database.reading() as session:
        everybody = progress_of_sessions(session, served, now)
        present = [each for each in everybody if each.present]
        counted = {each.id: each.arm for each in present if each.standing != "withdrawn"}
        trials = [each for each in answered_trials(session) if each.study_session in counted]
        names = served.study.display_names
        judged_checks = checks(session, served.study, counted)
        videos = played_videos(session, names)
        balance = sides(session, names)
        intake = current_intake(session)
        screened_out = count_screened_out(session)
    arms = count_places(served.study.arms, present, intake.more_places)
    places, left, items = total_places(arms), dropouts(present), checked_items(judged_checks)
    finished_at = [each.completed_at for each in present if each.completed_at]
    seconds = [each.seconds for each in present if each.completed_at and each.seconds is not None]
    whole = durations("whole study session", seconds)
    began = min((each.consented_at for each in present), default=None)
    expected = forecast(finished_at, places.remaining, began, now)
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
        screened_out=screened_out,
        leaving_out=_leaving_out(present),
        excluded=sum(each.excluded for each in present),
        progress=progress(trials, counted),
        dropouts=left,
        failed=tuple(
            FailedChecks(kind=kind, by_failures=tuple(sorted(Counter(failures.values()).items())))
            for kind in JUDGED
            if (failures := failed_by_session(judged_checks, kind))
        ),
        items=items,
        whole=whole,
        trials=trial_durations(trials, KINDS),
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
            announced_minutes=served.study.page.minutes,
        ),
    )


def places_so_far(database: Database, served: ServedStudy, now: datetime) -> PlaceCounts:
    """Return the counts of places of all arms together."""
    with database.reading() as session:
        everybody = progress_of_sessions(session, served, now)
        more = current_intake(session).more_places
    present = [each for each in everybody if each.present]
    return total_places(count_places(served.study.arms, present, more))


def _leaving_out(present: Sequence[SessionProgress]) -> tuple[SessionProgress, ...]:
    some = [each for each in present if each.left_out]
    return tuple(sorted(some, key=lambda each: -each.left_out)[:MOST_LISTED])
