"""A design in which people have taken part stays unchanged or becomes a new version."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import select, update

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import AuditLine
from studyapp.database.tables.study_session import Place, StudySession, StudyVersion
from studyapp.results.export.rows import watching_table
from studyapp.results.stated_beforehand import stated_study
from studyapp.session.refusal import ConflictError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import needs_new_version, open_study
from tests.support.read_once import read_once
from tests.support.studies.added_condition import add_condition, make_videos_anew
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant, SetClock

Change = Callable[..., ServedStudy]


@pytest.fixture
def change(tiny_study: Path) -> Change:
    """Return a function that changes the study file and reads the study anew."""

    def make(old: str, new: str) -> ServedStudy:
        redefine(tiny_study, (old, new))
        return ServedStudy.read(tiny_study)

    return make


def versions(database: Database) -> list[StudyVersion]:
    return list(found_in(database, select(StudyVersion).order_by(StudyVersion.number)))


def audit(database: Database) -> list[tuple[str, str]]:
    return [(line.event, line.detail) for line in found_in(database, select(AuditLine))]


def test_an_unused_design_may_change_and_its_old_server_admits_nobody(
    database: Database, served: ServedStudy, change: Change, clock: SetClock
) -> None:
    # Several servers may open the study at once.
    with ThreadPoolExecutor(4) as pool:
        for opening in [pool.submit(open_study, database, served, clock) for _ in range(4)]:
            opening.result()
    assert [version.number for version in versions(database)] == [1]
    assert sorted(found_in(database, select(Place.number))) == [0, 1, 2, 3]

    changed = change("trials = 4", "trials = 3")
    open_study(database, changed, clock)

    assert [(v.number, v.design) for v in versions(database)] == [(1, changed.design)]
    with pytest.raises(ConflictError, match="just been changed"):
        Participant(database, served, clock).enrol("late")


def test_a_changed_design_is_refused_once_somebody_has_enrolled(
    participant: Participant, tiny_study: Path, change: Change
) -> None:
    other_words = change("rhythm of the speech", "beat of the speech")
    change("beat of the speech", "rhythm of the speech")
    make_videos_anew(tiny_study)
    other_videos = ServedStudy.read(tiny_study)
    for changed, part in ((other_words, "questions"), (other_videos, "the speech or the videos")):
        with pytest.raises(InputError, match=rf"has changed \({part}\).*--new-version"):
            participant.in_study(changed)
    assert len(versions(participant.database)) == 1


def test_a_new_version_keeps_earlier_answers_separate(
    participant: Participant, tiny_study: Path
) -> None:
    participant.take_all()
    make_videos_anew(tiny_study)
    later = participant.in_study(ServedStudy.read(tiny_study), new_version=True)
    later.another().enrol("another").begin().trial()
    with participant.database.reading() as session:
        rows = session.scalars(select(StudySession).order_by(StudySession.id)).all()
        assert [row.version.number for row in rows] == [1, 2]
        assert len({row.place.design for row in rows if row.place}) == 2
    assert audit(participant.database) == [("new_version", "version 2")]
    seen = read_once(participant.database, watching_table).groupby("version")["made_from"].agg(set)
    assert all(key.endswith("anew") for key in seen[2])
    assert seen[1] and not seen[1] & seen[2]


def test_participants_stopped_by_a_new_version_continue_when_it_is_undone(
    participant: Participant, change: Change
) -> None:
    participant.take_trial()
    by_mistake = change("rhythm of the speech", "beat of the speech")
    assert participant.in_study(by_mistake, new_version=True).look().state == "lapsed"
    # Nobody has seen the new version: it may change, and it may go.
    replaced = change("beat of the speech", "pulse of the speech")
    participant.in_study(replaced)
    assert [(version.number, version.design) for version in versions(participant.database)] == [
        (1, participant.served.design),
        (2, replaced.design),
    ]

    undone = change("pulse of the speech", "rhythm of the speech")
    participant.in_study(undone).another().enrol("another")

    assert participant.trial().position == 2
    assert needs_new_version(participant.database, replaced.design)


def test_going_back_needs_confirmation_once_the_new_version_was_used(
    participant: Participant, change: Change
) -> None:
    database = participant.database
    second = change("rhythm of the speech", "beat of the speech")
    later = participant.in_study(second, new_version=True).another().enrol("later")
    first = change("beat of the speech", "rhythm of the speech")
    assert needs_new_version(database, first.design)
    with pytest.raises(InputError, match=r"design has changed.*--new-version"):
        participant.in_study(first)
    assert later.look().state == "instructed"
    participant.in_study(first, new_version=True)
    participant.in_study(first)
    assert [version.in_force for version in versions(database)] == [True, False]


def test_an_added_condition_leaves_other_comparisons_unchanged(
    participant: Participant, tiny_study: Path
) -> None:
    participant.take_trial()
    add_condition(tiny_study)
    later = participant.in_study(ServedStudy.read(tiny_study), new_version=True)
    assert later.trial().position == 2
    arms = [
        later.stored().arm,
        *(later.another().enrol(f"visit {n}").stored().arm for n in range(3)),
    ]
    assert sorted(arms) == ["rule_based-mismatched"] * 2 + ["rule_based-static"] * 2


def test_operational_settings_may_change_and_are_logged(
    participant: Participant, change: Change
) -> None:
    change("participants_per_comparison = 4", "participants_per_comparison = 6")
    change('contact = "gestures@example.org"', 'contact = "lab@example.org"')
    later = participant.in_study(change("minutes = 10", "minutes = 12"))
    assert len(versions(participant.database)) == 1
    assert audit(participant.database) == [
        (
            "operation_changed",
            "page.contact: 'gestures@example.org' -> 'lab@example.org'; "
            "page.minutes: 10 -> 12; participants_per_comparison: 4 -> 6",
        )
    ]
    assert len(found_in(participant.database, select(Place))) == 6
    assert later.trial().position == 1


OTHER_RULES = ("[catch]", '[[exclusions]]\nrule = "catch"\nmore_than = 0\n[catch]')


def stated_rules(database: Database) -> list[str]:
    stated = read_once(database, stated_study, 1)
    assert stated is not None
    return [rule.shorthand() for rule in stated.settled_exclusions]


def test_stated_rules_are_those_at_the_first_participants_arrival(
    opened: Database, served: ServedStudy, change: Change, clock: SetClock
) -> None:
    before = served.study
    open_study(opened, change(*OTHER_RULES), clock)
    first = Participant(opened, served, clock).in_study(change(*OTHER_RULES[::-1])).enrol()
    assert stated_rules(opened) == [rule.shorthand() for rule in before.settled_exclusions]

    first.in_study(change(*OTHER_RULES))

    assert stated_rules(opened) == ["incomplete", "catch>1"]
    assert audit(opened)[-1] == (
        "operation_changed",
        "exclusions: ['incomplete', 'catch>1'] -> ['catch>0']",
    )
    assert len(versions(opened)) == 1


def test_an_unreadable_version_states_no_rules(participant: Participant) -> None:
    with participant.database.writing() as session:
        session.execute(update(StudyVersion).values(definition="protocol = 'of earlier times'"))
    assert read_once(participant.database, stated_study, 1) is None
