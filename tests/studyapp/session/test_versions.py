"""The design of a study that people have taken part in stays as it is, or becomes a new version."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import select, update

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import AuditLine, Place, StudySession, StudyVersion
from studyapp.results.export.rows import watching_table
from studyapp.results.stated_beforehand import stated_study
from studyapp.session.refusal import ConflictError, StudyFullError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import must_be_new_version, open_study
from tests.redefining import redefine
from tests.studyapp.added_condition import add_condition, make_videos_anew
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant, SetClock

Change = Callable[..., ServedStudy]


@pytest.fixture
def change(tiny_study: Path) -> Change:
    """Return a function that changes the study file and reads the study anew."""

    def make(old: str, new: str) -> ServedStudy:
        redefine(tiny_study, (old, new))
        return ServedStudy.read(tiny_study)

    return make


def versions(database: Database) -> list[StudyVersion]:
    with database.reading() as session:
        return list(session.scalars(select(StudyVersion).order_by(StudyVersion.number)))


def audit(database: Database) -> list[tuple[str, str]]:
    with database.reading() as session:
        return [(line.event, line.detail) for line in session.scalars(select(AuditLine))]


def test_the_definition_is_kept_with_the_study_sessions_it_was_served_to(
    participant: Participant, tiny_study: Path
) -> None:
    with participant.database.reading() as session:
        version = session.scalars(select(StudySession)).one().version
    assert version.number == 1
    assert version.design == participant.served.design
    assert version.definition == (tiny_study / "study.toml").read_text("utf-8")


def test_several_servers_may_open_the_study_at_once(
    database: Database, served: ServedStudy, clock: SetClock
) -> None:
    with ThreadPoolExecutor(4) as pool:
        for opening in [pool.submit(open_study, database, served, clock) for _ in range(4)]:
            opening.result()

    assert [version.number for version in versions(database)] == [1]
    with database.reading() as session:
        assert sorted(session.scalars(select(Place.number))) == [0, 1, 2, 3]


def test_opening_twice_changes_nothing(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    open_study(opened, served, clock)

    assert len(versions(opened)) == 1
    assert audit(opened) == []


def test_a_design_that_nobody_has_seen_may_change(
    opened: Database, change: Change, clock: SetClock
) -> None:
    served = change("trials = 4", "trials = 3")

    open_study(opened, served, clock)

    assert [(v.number, v.design) for v in versions(opened)] == [(1, served.design)]


def test_a_server_of_a_design_that_was_replaced_lets_nobody_in(
    opened: Database, served: ServedStudy, change: Change, clock: SetClock
) -> None:
    open_study(opened, change("trials = 4", "trials = 3"), clock)

    with pytest.raises(ConflictError, match="just been changed"):
        Participant(opened, served, clock).enrol("late")


def test_a_changed_design_is_refused_once_somebody_has_come(
    participant: Participant, change: Change
) -> None:
    changed = change("rhythm of the speech", "beat of the speech")

    with pytest.raises(InputError, match=r"design has changed.*--new-version"):
        open_study(participant.database, changed, participant.clock)
    assert len(versions(participant.database)) == 1


def test_a_new_version_keeps_earlier_answers_apart(
    participant: Participant, change: Change
) -> None:
    participant.take_all()
    changed = change("rhythm of the speech", "beat of the speech")

    open_study(participant.database, changed, participant.clock, new_version=True)
    Participant(participant.database, changed, participant.clock).enrol("later")

    with participant.database.reading() as session:
        known = session.scalars(select(StudySession).order_by(StudySession.id))
        numbers = [study_session.version.number for study_session in known]
        places = session.scalars(select(Place).where(Place.study_session_id.is_not(None))).all()
        assert len({place.design for place in places}) == 2
    assert numbers == [1, 2]
    assert audit(participant.database) == [("new_version", "version 2")]


def test_a_new_version_that_nobody_has_seen_may_change_too(
    participant: Participant, change: Change
) -> None:
    second = change("rhythm of the speech", "beat of the speech")
    open_study(participant.database, second, participant.clock, new_version=True)
    third = change("beat of the speech", "pulse of the speech")

    open_study(participant.database, third, participant.clock)

    known = [(version.number, version.design) for version in versions(participant.database)]
    assert known == [(1, participant.served.design), (2, third.design)]


def test_a_design_that_replaces_a_mistake_which_was_undone_is_asked_about(
    participant: Participant, change: Change
) -> None:
    by_mistake = change("rhythm of the speech", "beat of the speech")
    open_study(participant.database, by_mistake, participant.clock, new_version=True)
    undone = change("beat of the speech", "rhythm of the speech")
    open_study(participant.database, undone, participant.clock)
    Participant(participant.database, undone, participant.clock).enrol("another")

    another = change("rhythm of the speech", "pulse of the speech")
    assert must_be_new_version(participant.database, another.design)
    with pytest.raises(InputError, match=r"design has changed.*--new-version"):
        open_study(participant.database, another, participant.clock)
    assert participant.look().state == "started"


def test_who_is_unfinished_keeps_the_place_where_a_mistaken_new_version_is_undone(
    participant: Participant, change: Change
) -> None:
    participant.take_trial()
    by_mistake = change("rhythm of the speech", "beat of the speech")
    open_study(participant.database, by_mistake, participant.clock, new_version=True)
    undone = change("beat of the speech", "rhythm of the speech")
    open_study(participant.database, undone, participant.clock)

    Participant(participant.database, undone, participant.clock).enrol("another")

    assert participant.trial().position == 2


def test_going_back_is_asked_about_once_somebody_has_come_to_the_new_version(
    participant: Participant, change: Change
) -> None:
    database, clock = participant.database, participant.clock
    second = change("rhythm of the speech", "beat of the speech")
    open_study(database, second, clock, new_version=True)
    later = Participant(database, second, clock).enrol("later")
    first = change("beat of the speech", "rhythm of the speech")

    assert must_be_new_version(database, first.design)
    with pytest.raises(InputError, match=r"design has changed.*--new-version"):
        open_study(database, first, clock)
    assert later.look().state == "instructed"

    open_study(database, first, clock, new_version=True)
    open_study(database, first, clock)
    assert [version.in_force for version in versions(database)] == [True, False]


def test_who_is_in_the_middle_of_what_has_changed_cannot_go_on(
    participant: Participant, change: Change
) -> None:
    participant.take_trial()
    changed = change("rhythm of the speech", "beat of the speech")

    open_study(participant.database, changed, participant.clock, new_version=True)

    later = Participant(participant.database, changed, participant.clock, participant.token)
    assert later.look().state == "lapsed"


def test_an_added_condition_leaves_the_other_comparisons_as_they_are(
    participant: Participant, tiny_study: Path
) -> None:
    participant.take_trial()
    add_condition(tiny_study)
    changed = ServedStudy.read(tiny_study)

    open_study(participant.database, changed, participant.clock, new_version=True)

    later = Participant(participant.database, changed, participant.clock, participant.token)
    assert later.trial().position == 2
    others = [Participant(participant.database, changed, participant.clock) for _ in range(3)]
    with participant.database.reading() as session:
        for number, other in enumerate(others):
            other.enrol(f"visit {number}")
        arms = sorted(session.scalars(select(StudySession.arm)))
    assert arms == ["rule_based-mismatched"] * 2 + ["rule_based-static"] * 2


def test_stimuli_that_are_made_from_something_else_are_another_design(
    participant: Participant, tiny_study: Path
) -> None:
    participant.take_all()
    make_videos_anew(tiny_study)
    changed = ServedStudy.read(tiny_study)

    with pytest.raises(InputError, match=r"design has changed.*--new-version"):
        open_study(participant.database, changed, participant.clock)

    open_study(participant.database, changed, participant.clock, new_version=True)
    Participant(participant.database, changed, participant.clock).enrol("later").begin().trial()
    seen = read_once(participant.database, watching_table).groupby("version")["made_from"].agg(set)
    assert all(key.endswith("anew") for key in seen[2])
    assert seen[1] and not seen[1] & seen[2]


def test_operation_may_change_and_leaves_a_line(participant: Participant, change: Change) -> None:
    changed = change("participants_per_comparison = 4", "participants_per_comparison = 6")
    change('contact = "gestures@example.org"', 'contact = "lab@example.org"')
    changed = change("minutes = 10", "minutes = 12")

    open_study(participant.database, changed, participant.clock)

    assert len(versions(participant.database)) == 1
    assert audit(participant.database) == [
        (
            "operation_changed",
            "page.contact: 'gestures@example.org' -> 'lab@example.org'; "
            "page.minutes: 10 -> 12; participants_per_comparison: 4 -> 6",
        )
    ]
    with participant.database.reading() as session:
        assert len(session.scalars(select(Place)).all()) == 6
    assert participant.trial().position == 1


def test_a_closed_study_lets_nobody_in_and_everybody_finish(
    participant: Participant, change: Change
) -> None:
    closed = change('title = "Gestures', 'open = false\ntitle = "Gestures')
    open_study(participant.database, closed, participant.clock)
    inside = Participant(participant.database, closed, participant.clock, participant.token)

    with pytest.raises(StudyFullError, match="takes no new participants"):
        Participant(participant.database, closed, participant.clock).enrol("new")
    assert inside.take_all()


def test_rules_that_change_before_the_first_participant_are_those_that_were_stated(
    opened: Database, change: Change, clock: SetClock
) -> None:
    served = change("[catch]", '[[exclusions]]\nrule = "catch"\nmore_than = 0\n[catch]')

    open_study(opened, served, clock)

    stated = read_once(opened, stated_study, 1)
    assert stated is not None
    assert [each.written() for each in stated.settled_exclusions] == ["catch>0"]


def test_rules_that_change_later_need_no_new_version_but_leave_the_stated_ones_as_they_were(
    participant: Participant, change: Change
) -> None:
    served = change("[catch]", '[[exclusions]]\nrule = "catch"\nmore_than = 0\n[catch]')

    open_study(participant.database, served, participant.clock)

    stated = read_once(participant.database, stated_study, 1)
    assert stated is not None
    assert [each.written() for each in stated.settled_exclusions] == ["incomplete", "catch>1"]
    assert audit(participant.database) == [
        ("operation_changed", "exclusions: ['incomplete', 'catch>1'] -> ['catch>0']")
    ]
    assert len(versions(participant.database)) == 1


def test_nothing_is_known_of_a_version_that_cannot_be_read(
    participant: Participant,
) -> None:
    with participant.database.writing() as session:
        session.execute(update(StudyVersion).values(definition="protocol = 'of earlier times'"))

    assert read_once(participant.database, stated_study, 1) is None
    assert read_once(participant.database, stated_study, 2) is None
