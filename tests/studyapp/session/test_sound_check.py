from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.session.arrivals import Arrival
from studyapp.session.ending import withdraw
from studyapp.session.enrolment import enrol, enrolled
from studyapp.session.form_answers import answer_form
from studyapp.session.participation import check_sound, digits_to_speak, leave_unheard
from studyapp.session.refusal import (
    ConflictError,
    StudyFullError,
    UnacceptableError,
    UnknownAddressError,
)
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.design.trial import Stimulus
from studyapp.study.settings.study import Study
from tests.functional.redefining import redefine
from tests.studyapp.exported import study_sessions_table
from tests.studyapp.read_once import read_once
from tests.studyapp.session.test_form_answers import ABOUT, ADULT, FORM
from tests.studyapp.taking_part_steps import Participant, SetClock


def listening(folder: Path, database: Database, clock: SetClock, more: str = "") -> Participant:
    """Return somebody who has agreed to take part in a study with a sound check."""
    redefine(folder, ("[page]\n", "[page]\nsound_check = true\n"), added=more)
    served = ServedStudy.read(folder)
    open_study(database, served, clock)
    return Participant(database, served, clock)


@pytest.fixture
def listener(tiny_study: Path, database: Database, clock: SetClock) -> Participant:
    return listening(tiny_study, database, clock).enrol()


def digits(participant: Participant) -> str:
    return digits_to_speak(participant.database, participant.served, participant.token)


def hear(participant: Participant, typed: str) -> bool:
    return check_sound(
        participant.database, participant.served, participant.token, typed, participant.clock
    )


def stored(participant: Participant) -> StudySession:
    with participant.database.reading() as session:
        named = select(StudySession).where(StudySession.token == participant.token)
        return session.scalars(named).one()


def wrong(spoken: str) -> str:
    return "".join(str((int(digit) + 1) % 10) for digit in spoken)


def test_the_digits_stay_the_same_and_are_typed_before_anything_else(listener: Participant) -> None:
    assert listener.look().sound_tries == 0
    assert listener.begin().look().state == "instructed"
    spoken = digits(listener)
    assert digits(listener) == spoken
    assert len(spoken) == 3

    assert hear(listener, spoken)

    assert listener.look().sound_tries is None
    assert listener.begin().look().state == "started"


@pytest.mark.parametrize("between", ["", " ", ", ", "-"])
def test_digits_may_be_typed_with_anything_between_them_and_in_any_width(
    listener: Participant, between: str
) -> None:
    wide = [chr(ord("０") + int(digit)) for digit in digits(listener)]

    assert hear(listener, between.join(wide))


def test_other_digits_are_counted_and_exclude_nobody(listener: Participant) -> None:
    spoken = digits(listener)
    for tries in range(1, 6):
        assert not hear(listener, wrong(spoken))
        assert listener.look().sound_tries == tries

    assert hear(listener, spoken)
    assert hear(listener, wrong(spoken))
    assert stored(listener).sound_tries == 5


def test_nothing_typed_is_no_try(listener: Participant) -> None:
    listener.look()

    with pytest.raises(UnacceptableError, match="No digits"):
        hear(listener, "none")
    assert listener.look().sound_tries == 0


def test_nothing_is_spoken_once_the_check_is_over(listener: Participant) -> None:
    hear(listener, digits(listener))

    with pytest.raises(ConflictError, match="over"):
        digits(listener)


def test_participants_hear_different_digits(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    first = listening(tiny_study, database, clock)
    spoken = set()
    for number in range(4):
        first.token = enrol(database, first.served, Arrival(visit=f"v{number}"), clock)
        spoken.add(digits(first))

    assert len(spoken) > 1


def test_leaving_is_open_after_three_tries_and_gives_the_place_back(listener: Participant) -> None:
    spoken = digits(listener)
    for _ in range(3):
        leave_unheard(listener.database, listener.served, listener.token, listener.clock)
        assert listener.look().state == "instructed"
        hear(listener, wrong(spoken))

    leave_unheard(listener.database, listener.served, listener.token, listener.clock)

    assert listener.look().state == "withdrawn"
    assert listener.look().left_unheard
    assert stored(listener).sound_tries == 3


def test_who_left_unheard_and_comes_again_begins_anew_as_one_study_session(
    listener: Participant,
) -> None:
    left = listener.token
    for _ in range(3):
        hear(listener, wrong(digits(listener)))
    leave_unheard(listener.database, listener.served, left, listener.clock)
    assert (
        enrolled(listener.database, listener.served, Arrival(visit="visit"), listener.clock) is None
    )

    listener.enrol()

    assert listener.token != left
    assert listener.look().sound_tries == 0
    assert (
        enrolled(listener.database, listener.served, Arrival(visit="visit"), listener.clock)
        == listener.token
    )
    assert len(read_once(listener.database, study_sessions_table)) == 1
    with pytest.raises(UnknownAddressError):
        replace(listener, token=left).look()


@pytest.mark.parametrize("recruiter", ["left", "other"])
def test_the_recruiters_name_of_who_left_unheard_may_be_used_again(
    tiny_study: Path, database: Database, clock: SetClock, recruiter: str
) -> None:
    listener = listening(tiny_study, database, clock)
    names = Arrival(recruiter_participant="left", recruiter_study="study")
    listener.token = enrol(database, listener.served, names, clock)
    for _ in range(3):
        hear(listener, wrong(digits(listener)))
    leave_unheard(database, listener.served, listener.token, clock)

    again = replace(names, recruiter_participant=recruiter)
    token = enrol(database, listener.served, again, clock)

    assert token != listener.token
    assert len(read_once(database, study_sessions_table)) == (1 if recruiter == "left" else 2)


def test_who_left_unheard_is_told_so_still_when_the_study_is_full_meanwhile(
    listener: Participant,
) -> None:
    for _ in range(3):
        hear(listener, wrong(digits(listener)))
    leave_unheard(listener.database, listener.served, listener.token, listener.clock)
    for number in range(4):
        enrol(listener.database, listener.served, Arrival(visit=f"v{number}"), listener.clock)

    with pytest.raises(StudyFullError):
        enrol(listener.database, listener.served, Arrival(visit="visit"), listener.clock)

    assert listener.look().left_unheard


def test_who_withdraws_otherwise_at_the_sound_check_does_not_begin_anew(
    listener: Participant,
) -> None:
    hear(listener, wrong(digits(listener)))
    withdraw(listener.database, listener.token, listener.clock)
    left = listener.token

    assert (
        enrolled(listener.database, listener.served, Arrival(visit="visit"), listener.clock) == left
    )
    assert listener.enrol().token == left


def test_who_heard_it_in_the_end_and_withdraws_has_not_left_unheard(
    listener: Participant,
) -> None:
    for _ in range(3):
        hear(listener, wrong(digits(listener)))
    hear(listener, digits(listener))
    withdraw(listener.database, listener.token, listener.clock)

    assert not listener.look().left_unheard


def test_who_withdraws_for_another_reason_has_not_left_unheard(listener: Participant) -> None:
    hear(listener, wrong(digits(listener)))
    withdraw(listener.database, listener.token, listener.clock)

    assert not listener.look().left_unheard


def test_questions_wait_for_the_sound_check(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    listener = listening(tiny_study, database, clock, FORM)
    arrival = Arrival(visit="visit", form=ADULT)
    listener.token = enrol(database, listener.served, arrival, clock)
    assert listener.look().form is None
    with pytest.raises(ConflictError, match="not the questions you are on"):
        answer_form(database, listener.served, listener.token, "demographics", ABOUT, clock)

    hear(listener, digits(listener))

    assert listener.look().form == "demographics"


def test_a_study_without_sound_has_no_sound_check(listener: Participant) -> None:
    silent = {
        tuple(Stimulus(condition=s.condition, segment=s.segment, speech=None) for s in content): f
        for content, f in listener.served.videos.items()
    }
    listener.served = replace(listener.served, videos=silent)

    assert listener.look().sound_tries is None
    assert listener.begin().look().state != "instructed"


def test_who_had_begun_before_the_check_was_asked_for_goes_on(
    participant: Participant, tiny_study: Path
) -> None:
    study: Study = participant.served.study
    page = study.page.model_copy(update={"sound_check": True})
    participant.served = replace(participant.served, study=study.model_copy(update={"page": page}))

    assert participant.look().sound_tries is None
