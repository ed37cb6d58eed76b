"""What needs a researcher's decision in a running study, by the rules stated here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.monitoring.answered_trials import Durations, Sides
from studyapp.monitoring.counts import Dropouts, PlaceCounts
from studyapp.monitoring.data_quality import CheckedItem, PlayedVideo

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


def decisions(
    *,
    places: PlaceCounts,
    open_to_newcomers: bool,
    videos: Sequence[PlayedVideo],
    items: Sequence[CheckedItem],
    sides: Sequence[Sides],
    left: Dropouts,
    whole: Durations,
    announced_minutes: int | None,
) -> tuple[Decision, ...]:
    """Return what needs a decision, the most urgent first.

    Parameters
    ----------
    whole : Durations
        Of whole study sessions.
    announced_minutes : int or None
        The duration that participants are told.
    """
    return (
        *_of_places(places, open_to_newcomers),
        *(decision for video in videos for decision in _of_video(video)),
        *(decision for item in items for decision in _of_item(item)),
        *_of_dropouts(left),
        *_of_duration(whole, announced_minutes),
        *(decision for condition in sides for decision in _of_sides(condition)),
    )


def _of_places(places: PlaceCounts, open_to_newcomers: bool) -> Iterator[Decision]:
    if places.remaining and not open_to_newcomers:
        yield Decision(
            what=f"{places.remaining} places are not done, and the study admits nobody new.",
            remedy="Admit participants again, here or by 'open = true' in study.toml, or leave it.",
        )


def _of_video(video: PlayedVideo) -> Iterator[Decision]:
    if video.unplayable >= MOST_UNPLAYABLE:
        yield Decision(
            what=f"{video.unplayable} of {video.shown} said that {video.what} does not play.",
            remedy="Play it yourself in several browsers; 'motionjury check' looks at its file.",
        )
    if video.shown < FEWEST_SHOWINGS:
        return
    if video.stalled / video.shown >= MOST_STALLED:
        yield Decision(
            what=f"{video.what} waited for data in {video.stalled} of {video.shown} showings, for "
            f"{video.stalled_seconds:.0f} s in all.",
            remedy="If it is this video alone, render it smaller; if it is all of them, let a "
            "web server in front send the videos.",
        )
    if video.dropped_share is not None and video.dropped_share >= MOST_DROPPED:
        yield Decision(
            what=f"Browsers left out {video.dropped_share:.0%} of the pictures of {video.what}.",
            remedy="A lower resolution or frame rate is easier to play.",
        )


def _of_item(item: CheckedItem) -> Iterator[Decision]:
    enough = item.careful >= FEWEST_CAREFUL
    if enough and item.careful_failed / item.careful >= MOST_CAREFUL_FAILED:
        yield Decision(
            what=f"The {item.kind} trial {item.item} was failed by {item.careful_failed} of "
            f"{item.careful} participants who failed no other one.",
            remedy="Watch it yourself: perhaps its right answer is not plain to see. To leave it "
            "out, say so in the report; the rules themselves were settled beforehand.",
        )


def _of_dropouts(left: Dropouts) -> Iterator[Decision]:
    for dropout in left.by_trial:
        if dropout.left >= FEWEST_LEFT and dropout.left / dropout.came >= MOST_LEFT:
            where = f"at trial {dropout.position}" if dropout.position else "before the first trial"
            yield Decision(
                what=f"{dropout.left} of {dropout.came} who came so far left {where}.",
                remedy="Take part yourself up to there, and look at what was refused to them.",
            )


def _of_duration(whole: Durations, announced_minutes: int | None) -> Iterator[Decision]:
    if announced_minutes is None or whole.middle is None:
        return
    minutes = whole.middle / 60
    if minutes > LONGER_THAN_SAID * announced_minutes:
        yield Decision(
            what=f"Half of them take longer than {minutes:.0f} min; {announced_minutes} are "
            "announced.",
            remedy="Announce and pay the time it takes ('minutes' in study.toml).",
        )


def _of_sides(sides: Sides) -> Iterator[Decision]:
    if not sides.balanced:
        yield Decision(
            what=f"{sides.condition} was shown {sides.left} times left and {sides.right} times "
            "right, which is unlikely by chance.",
            remedy="With few places done it may still even out; else look at the design's seed "
            "and at who was replaced.",
        )
