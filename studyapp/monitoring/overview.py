"""The overview of a running study, from one state of its database, and what needs a decision."""

import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from importlib.resources import files
from typing import Any, Final

from studyapp.database.engine import Database
from studyapp.monitoring import counts, data_quality
from studyapp.monitoring.answered_trials import (
    Durations,
    analysed_by_emotion,
    answered_trials,
    durations,
    trial_durations,
)
from studyapp.monitoring.study_sessions import SessionProgress, Standing, progress_of_sessions
from studyapp.session.ending import JUDGED
from studyapp.session.form_answers import count_screened_out
from studyapp.session.intake import current_intake, is_closed
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.study import Study

KINDS: Final = ("practice", "main", "repeat", *JUDGED)
MOST_LISTED: Final = 20
"""Rows of a list that may be very long."""

FEWEST_SHOWINGS: Final = 10
MOST_STALLED: Final = 0.2
MOST_DROPPED: Final = 0.1
"""Shares of a video's showings that stalled, and of its pictures that were left out."""

MOST_UNPLAYABLE: Final = 2

FEWEST_CAREFUL: Final = 5
MOST_CAREFUL_FAILED: Final = 0.3
"""Participants who failed nothing else, and the share of them that fails one check."""

FEWEST_LEFT: Final = 3
MOST_LEFT: Final = 0.1
"""Participants who left at one trial, and their share of those who came to it."""

LONGER_THAN_SAID: Final = 1.25


@dataclass(frozen=True, kw_only=True)
class Decision:
    """Something that a researcher should look at.

    Attributes
    ----------
    what, remedy : str
        What is wrong, with its numbers, and what can be done, as sentences.
    """

    what: str
    remedy: str


@dataclass(frozen=True, kw_only=True)
class Overview:
    """The study's progress at one moment.

    Attributes
    ----------
    at : datetime
    intake : str
        ``open``, ``paused`` or ``closed``, as far as the study file allows it.
    is_open : bool
        Whether the study file and the researchers' decision admit newcomers.
    announced_minutes : int or None
        The duration that participants are told.
    arms : tuple of PlaceCounts
    forecast : datetime or str
        When the last place will be done, or why there is no forecast.
    completions : Completions or None
        Places done over time; None if none is.
    standings : mapping of Standing to int
        How many study sessions there are of each; those of earlier versions are not counted.
    earlier : int
        Study sessions of earlier versions of the study, which are counted nowhere else.
    screened_out : mapping of str to int
        How many were screened out at each stage, in all versions of the study.
    excluded : int
        Study sessions that researchers exclude from the analysis; most hold places all the same.
    leaving_out : tuple of SessionProgress
        Participants who most often said that a video does not play, if at all.
    analysed : mapping of str to Counter
        Answered trials that are analysed, by emotion and arm; the emotion may be empty.
    failed : mapping of kind to mapping of int to int
        Numbers of failed checks of each kind, and how many participants failed so many.
    whole : Durations
        Durations of whole study sessions, from the first trial to the last answer.
    """

    at: datetime
    intake: str
    is_open: bool
    announced_minutes: int | None
    arms: tuple[counts.PlaceCounts, ...]
    forecast: datetime | str
    completions: counts.Completions | None
    standings: Mapping[Standing, int]
    earlier: int
    screened_out: Mapping[str, int]
    excluded: int
    leaving_out: tuple[SessionProgress, ...]
    analysed: Mapping[str, Counter[str]]
    dropouts: tuple[counts.Dropout, ...]
    failed: Mapping[str, Mapping[int, int]]
    items: tuple[data_quality.CheckedItem, ...]
    whole: Durations
    trials: tuple[Durations, ...]
    videos: tuple[data_quality.VideoShowings, ...]

    @property
    def places(self) -> counts.PlaceCounts:
        """The places of all arms together."""
        return counts.total_places(self.arms)

    @property
    def most_analysed(self) -> int:
        """The largest number of analysed trials of any emotion."""
        return max((by_arm.total() for by_arm in self.analysed.values()), default=0)

    @property
    def decisions(self) -> tuple[Decision, ...]:
        """What needs a decision, the most urgent first."""
        return tuple(
            Decision(**{part: text.format(**numbers) for part, text in _texts()[kind].items()})
            for kind, numbers in self._due()
        )

    def _due(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Yield the key in `decisions.toml` and the numbers of whatever needs a decision."""
        if self.places.remaining and not self.is_open:
            yield "not_admitted", vars(self.places)
        for video in self.videos:
            if video.unplayable >= MOST_UNPLAYABLE:
                yield "unplayable", vars(video)
            if video.shown < FEWEST_SHOWINGS:
                continue
            if video.stalled / video.shown >= MOST_STALLED:
                yield "stalled", vars(video)
            if video.dropped_share is not None and video.dropped_share >= MOST_DROPPED:
                yield "dropped", vars(video)
        for item in self.items:
            enough = item.careful >= FEWEST_CAREFUL
            if enough and item.careful_failed / item.careful >= MOST_CAREFUL_FAILED:
                yield "failed", vars(item)
        for dropout in self.dropouts:
            if dropout.left >= FEWEST_LEFT and dropout.left / dropout.came >= MOST_LEFT:
                yield "left" if dropout.position else "left_before", vars(dropout)
        minutes, announced = (self.whole.middle or 0) / 60, self.announced_minutes
        if announced is not None and minutes > LONGER_THAN_SAID * announced:
            yield "longer", {"minutes": minutes, "announced": announced}


@cache
def _texts() -> Mapping[str, Mapping[str, str]]:
    return tomllib.loads(files(__package__).joinpath("decisions.toml").read_text("utf-8"))


def overview(database: Database, served: ServedStudy, now: datetime) -> Overview:
    """Return the study's progress."""
    study = served.study
    with database.reading() as session:
        everybody = progress_of_sessions(session, served, now)
        present = [each for each in everybody if each.present]
        counted = {each.id: each.arm for each in present if each.standing != "withdrawn"}
        trials = [each for each in answered_trials(session) if each.study_session in counted]
        judged_checks = data_quality.checks(session, study, counted)
        videos = data_quality.played_videos(session, study.display_names)
        intake = current_intake(session)
        screened_out = count_screened_out(session)
    arms = counts.count_places(study.arms, present, intake.more_places)
    finished = [each for each in present if each.completed_at]
    ends = [(each.completed_at, each.standing) for each in finished if each.completed_at]
    done = [end for end, standing in ends if standing == "done"]
    places = counts.total_places(arms)
    began = min((each.consented_at for each in present), default=None)
    expected = counts.forecast([end for end, _ in ends], places.remaining, began, now)
    return Overview(
        at=now,
        intake=intake.state,
        is_open=study.open and intake.state == "open",
        announced_minutes=study.page.minutes,
        arms=arms,
        forecast=expected,
        completions=counts.completions(done, places.wanted, began, expected, now),
        standings=Counter(each.standing for each in present),
        earlier=len(everybody) - len(present),
        screened_out=screened_out,
        excluded=sum(each.excluded for each in present),
        leaving_out=_leaving_out(present),
        analysed=analysed_by_emotion(trials, counted),
        dropouts=counts.dropouts(present),
        failed={
            kind: dict(sorted(Counter(failures.values()).items()))
            for kind in JUDGED
            if (failures := data_quality.failed_by_session(judged_checks, kind))
        },
        items=data_quality.checked_items(judged_checks),
        whole=durations(
            "whole study session", [each.seconds for each in finished if each.seconds is not None]
        ),
        trials=trial_durations(trials, KINDS),
        videos=videos,
    )


def places_so_far(database: Database, served: ServedStudy, now: datetime) -> counts.PlaceCounts:
    """Return the counts of places of all arms together."""
    with database.reading() as session:
        everybody = progress_of_sessions(session, served, now)
        more = current_intake(session).more_places
    return counts.total_places(counts.count_places(served.study.arms, everybody, more))


EVERYBODY: Final = "everybody has finished"
CLOSED: Final = "the study is closed"
"""Reasons to look at the end, for the log, which nobody has to give."""


def over_because(database: Database, study: Study, places: counts.PlaceCounts) -> str:
    """Return why no more participants are expected; empty if some are."""
    if not places.remaining:
        return EVERYBODY
    return CLOSED if not places.active and is_closed(database, study) else ""


def _leaving_out(present: Sequence[SessionProgress]) -> tuple[SessionProgress, ...]:
    some = [each for each in present if each.left_out]
    return tuple(sorted(some, key=lambda each: -each.left_out)[:MOST_LISTED])
