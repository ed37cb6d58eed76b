"""Who was erased after a backup is erased from what is restored as well."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select

from motion.errors import InputError
from studyapp.custody.erased_since import ErasedAgain, erase_again, note_restored
from studyapp.custody.forgetting import forget
from studyapp.database.copies import write_copy
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import AuditLine, Event, Response, ScreenOut, StudySession
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.session.arrivals import Arrival, note_screen_out
from studyapp.session.ending import withdraw
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.studyapp.taking_part_steps import Participant, SetClock

PEOPLE = ("person-who-stays", "person-to-forget", "person-who-withdraws")
KEY = PseudonymKey(bytes(range(32)))

pytestmark = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)


@pytest.fixture
def people(opened: Database, served: ServedStudy, clock: SetClock) -> dict[str, Participant]:
    """Return three participants who have answered a trial each; a fourth was screened out."""
    made = {}
    for name in PEOPLE:
        arrival = Arrival(recruiter_participant=name, recruiter_study="one")
        made[name] = Participant(opened, served, clock).arrive(arrival).begin()
        made[name].take_trial()
    note_screen_out(opened, Arrival(recruiter_participant="screened-out"), clock)
    return made


@pytest.fixture
def restored(
    people: dict[str, Participant], database_url: str, tmp_path: Path
) -> Iterator[Database]:
    """Return the database as it was before anybody was erased."""
    write_copy(database_url, tmp_path / "earlier.db")
    database = Database.open(sqlite_url(tmp_path / "earlier.db"))
    yield database
    database.close()


def answers_by_person(database: Database) -> dict[str | None, int]:
    with database.reading() as session:
        return {
            known.recruiter_participant: len(
                session.scalars(
                    select(Response)
                    .join(Response.trial)
                    .where(Response.trial.property.mapper.class_.study_session_id == known.id)
                ).all()
            )
            for known in session.scalars(select(StudySession))
        }


def test_who_was_forgotten_withdrew_or_was_screened_out_is_erased_again(
    people: dict[str, Participant], restored: Database, clock: SetClock
) -> None:
    later = people[PEOPLE[0]].database
    clock.advance(minutes=1)
    forget(later, PEOPLE[1], KEY, clock)
    forget(later, "screened-out", KEY, clock)
    withdraw(later, people[PEOPLE[2]].token, clock)
    people[PEOPLE[0]].take_trial()

    assert erase_again(restored, later, KEY, clock) == ErasedAgain(
        forgotten=1, withdrawn=1, screened_out=1
    )

    assert answers_by_person(restored) == {PEOPLE[0]: 2, None: 0, PEOPLE[2]: 0}
    with restored.reading() as session:
        assert session.scalars(select(ScreenOut)).all() == []
        assert [line.event for line in session.scalars(select(AuditLine))] == [Event.FORGOTTEN]
    # The place is free again, as it is in the later state.
    assert Participant(restored, people[PEOPLE[0]].served, clock).enrol("newcomer").token


def test_who_was_forgotten_before_the_backup_is_left_as_they_are(
    people: dict[str, Participant], database_url: str, clock: SetClock, tmp_path: Path
) -> None:
    later = people[PEOPLE[0]].database
    forget(later, PEOPLE[1], KEY, clock)
    write_copy(database_url, tmp_path / "earlier.db")
    restored = Database.open(sqlite_url(tmp_path / "earlier.db"))

    assert erase_again(restored, later, KEY, clock) == ErasedAgain()
    restored.close()


def test_another_studys_later_state_is_refused(
    restored: Database, served: ServedStudy, clock: SetClock, tmp_path: Path
) -> None:
    clock.advance(minutes=1)
    another = Database.open(sqlite_url(tmp_path / "another.db"))
    open_study(another, served, clock)
    stranger = Participant(another, served, clock).enrol("stranger").begin()
    stranger.take_trial()
    forget(another, stranger.look().completion_code or "", KEY, clock)

    with pytest.raises(InputError, match="not a later state of the study"):
        erase_again(restored, another, KEY, clock)

    assert sum(answers_by_person(restored).values()) == 6
    another.close()


def test_a_study_that_went_on_from_another_backup_is_refused(
    people: dict[str, Participant], restored: Database, clock: SetClock
) -> None:
    later = people[PEOPLE[0]].database
    note_restored(restored, "as it was", clock)
    served = people[PEOPLE[0]].served
    for database, name in ((restored, "number four here"), (later, "number four there")):
        Participant(database, served, clock).enrol(name).begin().take_trial()
    forget(later, "number four there", KEY, clock)

    with pytest.raises(InputError, match="not a later state of the study"):
        erase_again(restored, later, KEY, clock)
