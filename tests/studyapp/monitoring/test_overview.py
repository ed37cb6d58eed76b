"""The overview of a study that people take part in, on both databases."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, update

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial, WatchRecord
from studyapp.monitoring.answered_trials import Durations
from studyapp.monitoring.counts import Dropout, PlaceCounts
from studyapp.monitoring.data_quality import CheckedItem, VideoShowings
from studyapp.monitoring.one_study_session import one_study_session
from studyapp.monitoring.overview import Overview, overview
from studyapp.monitoring.study_sessions import STANDINGS, Selection, list_study_sessions
from studyapp.session.ending import MIN_SKIPPED_TRIALS, withdraw
from studyapp.session.served_study import ServedStudy
from studyapp.session.watch_evidence import Playback
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import Participant, SetClock, taking_part


def people(database: Database, served: ServedStudy, clock: SetClock) -> None:
    """Let one finish, one withdraw, one go silent after two trials, and one be at the second."""
    comers = [Participant(database, served, clock).enrol(f"visit {n}") for n in range(3)]
    comers[0].begin().take_all()
    comers[1].begin().take_trial()
    withdraw(database, comers[1].token, clock)
    comers[2].begin().take_trial()
    comers[2].take_trial()
    clock.advance(minutes=served.study.lease_minutes + 1)
    last = Participant(database, served, clock).enrol("visit 3").begin()
    token = last.trial().videos[0].token
    clock.advance(seconds=5)
    last.fetch(token)
    report = Playback(stalls=2, stalled_seconds=1.5, frames=30, dropped_frames=3)
    last.report(token, (0.0, 2.0), playback=report)
    last.answer(last.trial().token)
    last.look()


@BOTH
def test_every_event_is_counted_once_and_lists_agree(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    people(opened, served, clock)
    found = overview(opened, served, clock.now())

    places = found.places
    assert (places.done, places.active, places.stale, places.open) == (1, 1, 0, 2)
    assert found.standings == {"done": 1, "active": 1, "lapsed": 1, "withdrawn": 1}
    assert found.earlier == 0
    assert found.dropouts == (Dropout(position=3, left=1, came=2),)
    analysed = sum(counts.total() for counts in found.analysed.values())
    assert analysed == sum(
        durations.count for durations in found.trials if durations.what in ("main", "repeat")
    )
    assert sum(durations.count for durations in found.trials) == 6 + 2 + 1
    stalled = [video for video in found.videos if video.stalled]
    assert [(v.stalled, v.stalled_seconds) for v in stalled] == [(1, 1.5)]
    assert sum(video.shown for video in found.videos) == 6 + 2 + 1
    shares = [video.dropped_share for video in found.videos]
    assert max(share for share in shares if share is not None) == pytest.approx(0.1)
    assert sum(found.failed["catch"].values()) == sum(item.answered for item in found.items)

    def count(**choice: Any) -> int:
        return len(list_study_sessions(opened, served, Selection(**choice), clock.now()))

    assert count(standing="active", arm=found.arms[0].arm) == found.arms[0].active
    for standing in STANDINGS:
        assert count(standing=standing) == found.standings[standing]
    assert count() == 4
    assert count(left_at=3) == 1
    for number, expected in found.failed["catch"].items():
        assert count(failed=("catch", number)) == expected
    assert count(arm="no such arm") == count(earlier=True) == 0


def test_study_sessions_of_another_design_are_counted_separately(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    people(opened, served, clock)
    with opened.writing() as session:
        session.execute(update(StudySession).values(arm_design="another"))

    found = overview(opened, served, clock.now())

    earlier = list_study_sessions(opened, served, Selection(earlier=True), clock.now())
    assert found.earlier == len(earlier) == 4
    assert (found.places.done, found.standings, found.analysed) == (0, {}, {})


def test_a_study_without_participants_has_an_overview(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    found = overview(opened, served, clock.now())

    assert found.places.open == found.places.wanted == 4
    assert found.forecast == "Nobody has begun yet"
    assert (found.videos, found.trials, found.items) == ((), (), ())
    assert found.decisions == ()


def test_opposite_answers_look_the_same(tiny_study: Path) -> None:
    found = []
    for rhythm, emotion in (("2", "-2"), ("-2", "2")):
        with taking_part(tiny_study, f"{rhythm}.db") as one:
            one.enrol().begin()
            while (trial := one.look().trial) is not None:
                with one.database.reading() as session:
                    better = session.scalar(
                        select(Trial.expected).where(Trial.token == trial.token)
                    )
                right = {1: "-2", 2: "2"}.get(better or 0)
                one.take_trial({"rhythm": right or rhythm, "emotion": right or emotion})
            found.append(overview(one.database, one.served, one.clock.now()))

    assert found[0] == found[1]


def test_participants_who_skipped_too_many_videos_are_listed_with_the_number(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    first, second = (Participant(opened, served, clock).enrol(name).begin() for name in "ab")
    second.leave_out()
    while first.look().state == "started":
        first.leave_out()

    found = overview(opened, served, clock.now())

    assert found.standings == {"unwatched": 1, "active": 1}
    assert [(each.id, each.standing, each.left_out) for each in found.leaving_out] == [
        (1, "unwatched", MIN_SKIPPED_TRIALS + 1),
        (2, "active", 1),
    ]


VIDEO = VideoShowings(
    what="s: a | b", shown=20, stalled=0, stalled_seconds=0.0, dropped_share=0.01, unplayable=0
)
ITEM = CheckedItem(
    kind="catch", item="s: a and broken", answered=20, failed=9, careful=10, careful_failed=3
)


def left(count: int, came: int, position: int = 3) -> tuple[Dropout, ...]:
    return (Dropout(position=position, left=count, came=came),)


@pytest.fixture
def quiet(opened: Database, served: ServedStudy, clock: SetClock) -> Overview:
    """Return an overview in which nothing needs a decision."""
    return replace(
        overview(opened, served, clock.now()),
        arms=(PlaceCounts(arm="", wanted=10, done=4, active=1, stale=0),),
        whole=Durations(what="whole", count=9, low=500.0, middle=600.0, high=700.0),
        announced_minutes=10,
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"is_open": False}, "4 of 10 places are done, and nobody new is admitted"),
        ({"videos": (replace(VIDEO, unplayable=2),)}, "2 of 20 said that s: a | b does not play"),
        (
            {"videos": (replace(VIDEO, stalled=4, stalled_seconds=12.0),)},
            "waited for data in 4 of 20 showings, for 12 s",
        ),
        ({"videos": (replace(VIDEO, dropped_share=0.25),)}, "left out 25% of the pictures"),
        ({"items": (ITEM,)}, "failed by 3 of 10 participants who failed no other one"),
        ({"dropouts": left(3, 30)}, "3 of 30 who came so far left at trial 3"),
        ({"dropouts": left(5, 30, position=0)}, "left before the first trial"),
        ({"announced_minutes": 7}, "longer than 10 min; 7 are announced"),
    ],
)
def test_findings_come_with_their_numbers_and_a_remedy(
    quiet: Overview, change: dict[str, Any], message: str
) -> None:
    (decision,) = replace(quiet, **change).decisions

    assert message in decision.what
    assert decision.remedy


def test_chance_and_single_events_need_no_decision(quiet: Overview) -> None:
    for change in (
        {},
        {"videos": (replace(VIDEO, unplayable=1),)},
        {"videos": (replace(VIDEO, stalled=3),)},
        {"videos": (replace(VIDEO, shown=9, stalled=9, dropped_share=0.5),)},
        {"videos": (replace(VIDEO, dropped_share=None),)},
        {"items": (replace(ITEM, careful_failed=2), replace(ITEM, careful=4, careful_failed=4))},
        {"dropouts": left(2, 4)},
        {"dropouts": left(3, 31)},
        {"announced_minutes": 8},
        {"announced_minutes": None},
        {"whole": Durations(what="whole", count=2), "announced_minutes": 1},
        {"arms": (PlaceCounts(arm="", wanted=10, done=10, active=0, stale=0),), "is_open": False},
    ):
        assert replace(quiet, **change).decisions == (), change


def test_the_page_of_a_study_session_lists_its_events_in_order(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    people(opened, served, clock)
    with opened.writing() as session:
        session.execute(
            update(WatchRecord)
            .where(WatchRecord.id == 1)
            .values(rate=2.0, intervals=[], hidden_seconds=1.5, silent_seconds=0.5)
        )
    Participant(opened, served, clock).enrol("visit 4").begin().leave_out()

    first, withdrawn = (one_study_session(opened, served, n, clock.now()) for n in (1, 2))
    last = one_study_session(opened, served, 4, clock.now())

    assert first is not None
    assert [event.at for event in first.events] == sorted(event.at for event in first.events)
    assert first.events[0].what == "Agreed to take part"
    assert first.events[-1].what == "Finished, and got a completion code"
    played = next(event for event in first.events if event.what.startswith("Had played"))
    assert played.what == (
        "Had played 2.0 s of the video, 0.0 s of its 2.0 s count as watched, "
        "at up to 2 times the speed, 1.5 s out of sight, 0.5 s unheard"
    )
    assert played.trouble
    assert [trial.watched for trial in first.trials][:2] == [0.0, 1.0]
    assert {trial.outcome for trial in first.trials} <= {"answered", "passed", "failed"}
    assert withdrawn is not None
    assert (withdrawn.trials, withdrawn.events[-1].what) == ((), "Withdrew")
    assert last is not None
    assert any("2 stalls of 1.5 s" in event.what for event in last.events)
    assert [trial.outcome for trial in last.trials][:2] == ["answered", ""]
    left_out = one_study_session(opened, served, 5, clock.now())
    assert left_out is not None
    assert left_out.trials[0].outcome == "does not play"
    assert [event.what for event in left_out.events if event.trouble] == [
        "Said that the video does not play",
        "Went on without trial 1",
    ]
    assert one_study_session(opened, served, 99, clock.now()) is None
