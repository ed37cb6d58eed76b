from __future__ import annotations

import pytest
from sqlalchemy import select

from studyapp.database.tables import FormAnswer
from studyapp.results.export.rows import form_answers_table
from studyapp.session.arrivals import Arrival
from studyapp.session.form_answers import store_form_answers
from studyapp.session.refusal import ConflictError, UnacceptableError
from tests.studyapp.session.conftest import Open
from tests.support.read_once import read_once
from tests.support.studies.asked_forms import ABOUT, ADULT, FORM
from tests.support.studies.taking_part_steps import Participant


@pytest.fixture
def asking(open_changed: Open) -> Participant:
    """Return somebody who has come to a study that asks about its participants."""
    return open_changed(added=FORM)


def come(participant: Participant, **form: str) -> Participant:
    return participant.arrive(Arrival(visit="visit", form=form))


def stored(participant: Participant) -> list[tuple[str, str, str]]:
    with participant.database.reading() as session:
        rows = session.scalars(select(FormAnswer).order_by(FormAnswer.id))
        return [(row.stage, row.question, row.value) for row in rows]


def test_questions_come_before_the_trials_and_after_them(asking: Participant) -> None:
    come(asking, **ADULT)
    assert asking.look().form == "demographics"
    assert asking.begin().look().state == "instructed"

    asking.do(store_form_answers, "demographics", ABOUT)
    assert asking.begin().look().form is None
    while asking.look().trial is not None:
        asking.take_trial()

    assert (asking.look().form, asking.look().completion_code) == ("closing", None)
    asking.do(store_form_answers, "closing", {"comment": "Good."})
    assert asking.look().completion_code
    table = read_once(asking.database, form_answers_table)
    assert table["question"].tolist() == ["adult", "age", "work", "comment"]
    assert stored(asking) == [
        ("eligibility", "adult", "yes"),
        ("demographics", "age", "31"),
        ("demographics", "work", ""),
        ("closing", "comment", "Good."),
    ]


def test_the_same_answers_twice_are_stored_once_and_others_are_refused(
    asking: Participant,
) -> None:
    come(asking, **ADULT)
    asking.do(store_form_answers, "demographics", ABOUT)
    asking.do(store_form_answers, "demographics", ABOUT)

    with pytest.raises(ConflictError, match="already answered"):
        asking.do(store_form_answers, "demographics", {"age": "32"})
    assert len(stored(asking)) == 3


def test_every_question_that_needs_another_answer_is_named(asking: Participant) -> None:
    come(asking, **ADULT)
    with pytest.raises(UnacceptableError, match="Question 1 needs a whole number from 18 to 120"):
        asking.do(store_form_answers, "demographics", {"age": "17"})
    too_long = "x" * 2001

    with pytest.raises(UnacceptableError, match="Questions 1 and 2 have no answer yet, or one"):
        asking.do(store_form_answers, "demographics", {"age": "", "work": too_long})
    with pytest.raises(UnacceptableError, match="to question 2 is longer than 2000 characters"):
        asking.do(store_form_answers, "demographics", {"age": "31", "work": too_long})
    assert asking.look().form == "demographics"


def test_closing_questions_cannot_be_answered_before_the_trials(asking: Participant) -> None:
    come(asking, **ADULT)

    with pytest.raises(ConflictError, match="not the questions you are on"):
        asking.do(store_form_answers, "closing", {"comment": "Early."})
