import pytest
from sqlalchemy import select

from studyapp.database.tables.study_session import FormAnswer, Place, ScreenOut, StudySession
from studyapp.database.tables.trial import Trial
from studyapp.results.export.rows import form_answers_table
from studyapp.session.enrolment import Arrival
from studyapp.session.form_answers import count_screened_out, store_form_answers
from studyapp.session.refusal import (
    ConflictError,
    IneligibleError,
    UnacceptableError,
    UnknownAddressError,
)
from tests.studyapp.session.conftest import Open
from tests.support.read_once import read_once
from tests.support.studies.form_questions import ABOUT, ADULT, COMPREHENSION, FORM
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant


def test_questions_before_and_after_the_trials_are_answered_once(open_changed: Open) -> None:
    asking = open_changed(added=FORM).arrive(Arrival(visit="visit", form=ADULT))
    assert asking.look().form == "demographics"
    assert asking.begin().look().state == "instructed"
    with pytest.raises(ConflictError, match="not the page you are on"):
        asking.do(store_form_answers, "closing", {"comment": "Early."})
    # Every question that needs another answer is named.
    for answers, words in (
        ({"age": "17"}, "Question 1 needs a whole number from 18 to 120"),
        ({"age": "121"}, "Question 1 needs a whole number from 18 to 120"),
        ({"age": "", "work": "x" * 2001}, "Questions 1 and 2 have no answer yet, or one"),
    ):
        with pytest.raises(UnacceptableError, match=words):
            asking.do(store_form_answers, "demographics", answers)

    for _ in range(2):
        asking.do(store_form_answers, "demographics", ABOUT)
    with pytest.raises(ConflictError, match="already answered"):
        asking.do(store_form_answers, "demographics", {"age": "32"})
    assert asking.begin().look().form is None
    while asking.look().trial is not None:
        asking.take_trial()

    assert (asking.look().form, asking.look().completion_code) == ("closing", None)
    asking.do(store_form_answers, "closing", {"comment": "Good."})
    assert asking.look().completion_code
    table = read_once(asking.database, form_answers_table)
    assert table["question"].tolist() == ["adult", "age", "work", "comment"]
    rows = found_in(asking.database, select(FormAnswer).order_by(FormAnswer.id))
    assert [(row.stage, row.question, row.value) for row in rows] == [
        ("eligibility", "adult", "yes"),
        ("demographics", "age", "31"),
        ("demographics", "work", ""),
        ("closing", "comment", "Good."),
    ]


@pytest.fixture
def reader(open_changed: Open) -> Participant:
    """Return somebody who reads the instructions of a study that asks about them."""
    return open_changed(added=COMPREHENSION)


def test_an_unanswered_question_is_not_an_attempt_and_a_wrong_answer_leaves_one(
    reader: Participant,
) -> None:
    reader.enrol()
    for answer in ("", "the hats"):
        with pytest.raises(UnacceptableError):
            reader.begin(judged=answer)
    # The page of the first try may be sent again, by a double click or a reload.
    for answer in ("the clothes", "the clothes", "the gestures"):
        with pytest.raises(UnacceptableError, match="one more try"):
            reader.begin(judged=answer)
    assert (reader.look().state, reader.look().has_tried_comprehension) == ("instructed", True)

    again = reader.begin(judged="the gestures", tries=1)
    assert again.look().state == "started"
    assert found_in(reader.database, select(FormAnswer.value)) == ["the clothes"]


@pytest.mark.parametrize("arrival", [Arrival(visit="visit"), Arrival(recruiter_participant="p1")])
def test_two_wrong_attempts_leave_no_data_and_free_the_place(
    reader: Participant, arrival: Arrival
) -> None:
    with pytest.raises(UnacceptableError):
        reader.arrive(arrival).begin(judged="the clothes")

    # The page of the second try may be sent again as well.
    for _ in range(2):
        with pytest.raises(IneligibleError):
            reader.begin(judged="the clothes", tries=1)

    with pytest.raises(UnknownAddressError):
        reader.look()
    for table in (StudySession, Trial, FormAnswer, ScreenOut):
        assert found_in(reader.database, select(table)) == []
    assert set(found_in(reader.database, select(Place.study_session_id))) == {None}
    counts = read_once(reader.database, count_screened_out)
    assert counts == {"eligibility": 0, "consent": 0, "comprehension": 1}
    assert reader.arrive(arrival).begin(judged="the gestures").look().state == "started"
