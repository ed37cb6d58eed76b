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


def test_questions_come_before_the_trials_and_after_them_and_are_answered_once(
    open_changed: Open,
) -> None:
    asking = open_changed(added=FORM).arrive(Arrival(visit="visit", form=ADULT))
    assert asking.look().form == "demographics"
    assert asking.begin().look().state == "instructed"
    with pytest.raises(ConflictError, match="not the questions you are on"):
        asking.do(store_form_answers, "closing", {"comment": "Early."})
    # Every question that needs another answer is named.
    for answers, words in (
        ({"age": "17"}, "Question 1 needs a whole number from 18 to 120"),
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
    with asking.database.reading() as session:
        rows = session.scalars(select(FormAnswer).order_by(FormAnswer.id))
        assert [(row.stage, row.question, row.value) for row in rows] == [
            ("eligibility", "adult", "yes"),
            ("demographics", "age", "31"),
            ("demographics", "work", ""),
            ("closing", "comment", "Good."),
        ]
