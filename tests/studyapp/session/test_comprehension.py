"""Questions under the instructions: two tries, and then somebody else gets the place."""

from __future__ import annotations

import pytest
from sqlalchemy import func, select

from studyapp.database.tables import FormAnswer, Place, ScreenOut, StudySession, Trial
from studyapp.session.form_answers import count_screened_out
from studyapp.session.refusal import IneligibleError, UnacceptableError, UnknownAddressError
from tests.studyapp.session.conftest import Open
from tests.support.studies.asked_forms import COMPREHENSION
from tests.support.studies.taking_part_steps import Participant


@pytest.fixture
def reader(open_changed: Open) -> Participant:
    """Return somebody who reads the instructions of a study that asks about them."""
    return open_changed(added=COMPREHENSION).enrol()


def test_an_open_question_is_no_try_and_a_wrong_answer_leaves_one_more(reader: Participant) -> None:
    for answer in ("", "the hats"):
        with pytest.raises(UnacceptableError):
            reader.begin(judged=answer)
    with pytest.raises(UnacceptableError, match="one more try"):
        reader.begin(judged="the clothes")
    assert reader.look().state == "instructed"

    assert reader.begin(judged="the gestures").look().state == "started"
    with reader.database.reading() as session:
        assert session.scalars(select(FormAnswer.value)).all() == ["the clothes"]


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
        assert session.scalars(select(ScreenOut)).all() == []
        counts = count_screened_out(session)
    assert counts == {"eligibility": 0, "consent": 0, "comprehension": 1}
    assert reader.enrol().begin(judged="the gestures").look().state == "started"
