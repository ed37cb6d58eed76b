from __future__ import annotations

from typing import Any

import pytest

from studyapp.monitoring.answered_trials import Durations, Sides
from studyapp.monitoring.counts import Dropout, Dropouts, PlaceCounts
from studyapp.monitoring.data_quality import CheckedItem, PlayedVideo
from studyapp.monitoring.decisions import decisions

QUIET: dict[str, Any] = {
    "places": PlaceCounts(arm="", wanted=10, done=4, active=1, stale=0),
    "open_to_newcomers": True,
    "videos": (),
    "items": (),
    "sides": (),
    "left": Dropouts(by_trial=(), withdrawn=0, came=5),
    "whole": Durations(what="whole", count=9, low=500.0, middle=600.0, high=700.0),
    "announced_minutes": 10,
}


def video(**changes: Any) -> PlayedVideo:
    values: dict[str, Any] = {
        "what": "s: a | b",
        "shown": 20,
        "stalled": 0,
        "stalled_seconds": 0.0,
        "dropped_share": 0.01,
        "reason": "",
        "unplayable": 0,
    }
    return PlayedVideo(**(values | changes))


def item(careful: int, careful_failed: int) -> CheckedItem:
    return CheckedItem(
        kind="catch",
        item="s: a and broken",
        answered=20,
        failed=9,
        careful=careful,
        careful_failed=careful_failed,
    )


def left(count: int, came: int, position: int = 3) -> Dropouts:
    by_trial = (Dropout(position=position, left=count, came=came),)
    return Dropouts(by_trial=by_trial, withdrawn=0, came=came)


def test_a_healthy_study_needs_no_decision() -> None:
    assert decisions(**QUIET) == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"open_to_newcomers": False}, "6 places are not done"),
        ({"videos": (video(unplayable=2),)}, "2 of 20 said that s: a | b does not play"),
        (
            {"videos": (video(stalled=4, stalled_seconds=12.0),)},
            "waited for data in 4 of 20 showings, for 12 s",
        ),
        ({"videos": (video(dropped_share=0.25),)}, "left out 25% of the pictures"),
        ({"items": (item(10, 3),)}, "failed by 3 of 10 participants who failed no other one"),
        ({"left": left(3, 30)}, "3 of 30 who came so far left at trial 3"),
        ({"left": left(5, 30, position=0)}, "left before the first trial"),
        ({"announced_minutes": 7}, "longer than 10 min; 7 are announced"),
        (
            {"sides": (Sides(condition="ours", left=66, right=34),)},
            "ours was shown 66 times left and 34 times right",
        ),
    ],
)
def test_findings_come_with_their_numbers_and_a_remedy(
    change: dict[str, Any], message: str
) -> None:
    (found,) = decisions(**(QUIET | change))

    assert message in found.what
    assert found.remedy


@pytest.mark.parametrize(
    "change",
    [
        {"videos": (video(unplayable=1),)},
        {"videos": (video(stalled=3),)},
        {"videos": (video(shown=9, stalled=9, dropped_share=0.5),)},
        {"videos": (video(dropped_share=None, reason="no browser counts them"),)},
        {"items": (item(10, 2), item(4, 4))},
        {"left": left(2, 4)},
        {"left": left(3, 31)},
        {"announced_minutes": 8},
        {"announced_minutes": None},
        {"whole": Durations(what="whole", count=2), "announced_minutes": 1},
        {"sides": (Sides(condition="ours", left=64, right=36),)},
        {
            "places": PlaceCounts(arm="", wanted=10, done=10, active=0, stale=0),
            "open_to_newcomers": False,
        },
    ],
)
def test_chance_and_single_events_need_no_decision(change: dict[str, Any]) -> None:
    assert decisions(**(QUIET | change)) == ()
