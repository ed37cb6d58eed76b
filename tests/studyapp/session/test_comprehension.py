"""Questions under the instructions: two tries, and then somebody else gets the place."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, Place, StudySession, Trial
from studyapp.session.refusal import IneligibleError, UnacceptableError, UnknownAddressError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.redefining import redefine
from tests.studyapp.taking_part_steps import Participant, SetClock

COMPREHENSION = """
[[form.comprehension]]
name = "judged"
text = "What are you to judge?"
choices = ["the clothes", "the gestures"]
eligible = ["the gestures"]
"""


@pytest.fixture
def reader(tiny_study: Path, database: Database, clock: SetClock) -> Participant:
    """Return somebody who reads the instructions of a study that asks about them."""
    redefine(tiny_study, added=COMPREHENSION)
    served = ServedStudy.read(tiny_study)
    open_study(database, served, clock)
    return Participant(database, served, clock).enrol()


def first_answers(participant: Participant) -> list[str]:
    with participant.database.reading() as session:
        return list(session.scalars(select(FormAnswer.value)))


def test_the_right_answer_leads_to_the_first_trial(reader: Participant) -> None:
    assert reader.begin(judged="the gestures").look().trial is not None
    assert first_answers(reader) == ["the gestures"]


def test_an_open_question_is_no_try_and_a_wrong_answer_leaves_one_more(reader: Participant) -> None:
    for answer in ("", "the hats"):
        with pytest.raises(UnacceptableError):
            reader.begin(judged=answer)
    with pytest.raises(UnacceptableError, match="one more try"):
        reader.begin(judged="the clothes")
    assert reader.look().state == "instructed"

    assert reader.begin(judged="the gestures").look().state == "started"
    assert first_answers(reader) == ["the clothes"]


def test_nothing_stays_of_who_is_wrong_twice_and_the_place_is_open_again(
    reader: Participant,
) -> None:
    with pytest.raises(UnacceptableError):
        reader.begin(judged="the clothes")

    with pytest.raises(IneligibleError):
        reader.begin(judged="the clothes")

    with pytest.raises(UnknownAddressError):
        reader.look()
    with reader.database.reading() as session:
        for table in (StudySession, Trial, FormAnswer):
            assert session.scalar(select(func.count()).select_from(table)) == 0
        assert session.scalars(select(Place.study_session_id).distinct()).all() == [None]
    assert reader.enrol().begin(judged="the gestures").look().state == "started"


def test_who_has_begun_is_not_asked_again(reader: Participant) -> None:
    reader.begin(judged="the gestures")

    for _ in range(3):
        assert reader.begin(judged="the clothes").look().state == "started"
