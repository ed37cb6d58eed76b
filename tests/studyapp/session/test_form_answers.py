from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, StudySession
from studyapp.results.export.rows import form_answers_table
from studyapp.session.arrivals import Arrival
from studyapp.session.enrolment import enrol
from studyapp.session.form_answers import answer_form
from studyapp.session.refusal import ConflictError, IneligibleError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.functional.redefining import redefine
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant, SetClock

FORM = """
[[form.eligibility]]
name = "adult"
text = "Are you 18 or older?"
choices = ["yes", "no"]
eligible = ["yes"]

[[form.demographics]]
name = "age"
text = "How old are you?"
kind = "number"
low = 18

[[form.demographics]]
name = "work"
text = "What do you work on?"
kind = "text"
required = false

[[form.closing]]
name = "comment"
text = "Is there anything you want to tell us?"
kind = "text"
required = false
"""
ADULT = {"adult": "yes"}
ABOUT = {"age": "31", "work": ""}


@pytest.fixture
def asking(tiny_study: Path, database: Database, clock: SetClock) -> Participant:
    """Return somebody who has come to a study that asks about its participants."""
    redefine(tiny_study, added=FORM)
    served = ServedStudy.read(tiny_study)
    open_study(database, served, clock)
    return Participant(database, served, clock)


def come(participant: Participant, **form: str) -> Participant:
    arrival = Arrival(visit="visit", form=form)
    participant.token = enrol(participant.database, participant.served, arrival, participant.clock)
    return participant


def tell(participant: Participant, stage: str, answers: dict[str, str]) -> None:
    answer_form(
        participant.database,
        participant.served,
        participant.token,
        stage,  # type: ignore[arg-type]
        answers,
        participant.clock,
    )


def stored(participant: Participant) -> list[tuple[str, str, str]]:
    with participant.database.reading() as session:
        rows = session.scalars(select(FormAnswer).order_by(FormAnswer.id))
        return [(row.stage, row.question, row.value) for row in rows]


def test_who_is_not_eligible_is_told_so_and_nothing_is_stored(asking: Participant) -> None:
    with pytest.raises(IneligibleError):
        come(asking, adult="no")

    with asking.database.reading() as session:
        assert session.scalars(select(StudySession)).all() == []


@pytest.mark.parametrize("form", [{}, {"adult": "perhaps"}])
def test_nobody_comes_in_without_answering_at_the_entrance(
    asking: Participant, form: dict[str, str]
) -> None:
    with pytest.raises(UnacceptableError, match="Question 1"):
        come(asking, **form)


def test_questions_come_before_the_trials_and_after_them(asking: Participant) -> None:
    come(asking, **ADULT)
    assert asking.look().form == "demographics"
    assert asking.begin().look().state == "instructed"

    tell(asking, "demographics", ABOUT)
    assert asking.begin().look().form is None
    while asking.look().trial is not None:
        asking.take_trial()

    assert (asking.look().form, asking.look().completion_code) == ("closing", None)
    tell(asking, "closing", {"comment": "Good."})
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
    tell(asking, "demographics", ABOUT)
    tell(asking, "demographics", ABOUT)

    with pytest.raises(ConflictError, match="already answered"):
        tell(asking, "demographics", {"age": "32"})
    assert len(stored(asking)) == 3


def test_an_answer_that_cannot_be_one_stores_nothing(asking: Participant) -> None:
    come(asking, **ADULT)

    with pytest.raises(UnacceptableError, match="Question 1 needs a whole number from 18 to 120"):
        tell(asking, "demographics", {"age": "17"})
    assert asking.look().form == "demographics"


def test_every_question_that_needs_another_answer_is_named(asking: Participant) -> None:
    come(asking, **ADULT)
    too_long = "x" * 2001

    with pytest.raises(UnacceptableError, match="Questions 1 and 2 have no answer yet, or one"):
        tell(asking, "demographics", {"age": "", "work": too_long})
    with pytest.raises(UnacceptableError, match="to question 2 is longer than 2000 characters"):
        tell(asking, "demographics", {"age": "31", "work": too_long})
    assert asking.look().form == "demographics"


def test_closing_questions_cannot_be_answered_before_the_trials(asking: Participant) -> None:
    come(asking, **ADULT)

    with pytest.raises(ConflictError, match="not the questions you are on"):
        tell(asking, "closing", {"comment": "Early."})
