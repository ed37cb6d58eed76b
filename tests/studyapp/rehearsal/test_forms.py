from __future__ import annotations

import pytest
from bs4 import BeautifulSoup

from studyapp.rehearsal.forms import Form, IncompleteFormError, read_form

RANKED = """<form method="post">
  <select name="realism:1" aria-label="Rank of A"><option value="">choose …</option>
    <option value="1">1</option><option value="2">2</option></select>
  <label for="age">Age</label> <input type="number" id="age" name="age" min="18" max="99">
  <label><input type="checkbox" name="fit:reasons" value="hands"> the hands</label>
  <label><input type="checkbox" name="fit:reasons" value="face"> the face</label>
  <span id="said">Anything else?</span> <textarea name="comment" aria-labelledby="said"></textarea>
  <button>Next</button>
</form>"""
ANSWERS = {"realism:1": ("2",), "age": ("31",), "comment": ("–",)}


def form(html: str) -> Form:
    soup = BeautifulSoup(html, "html.parser")
    (found,) = soup.find_all("form")
    return read_form(soup, found)


def test_menus_numbers_boxes_and_text_are_filled_in() -> None:
    answers = {**ANSWERS, "fit:reasons": ("hands", "face")}
    assert form(RANKED).filled(answers) == {key: list(value) for key, value in answers.items()}


def test_boxes_may_stay_empty_and_everything_else_waits_for_an_answer() -> None:
    assert form(RANKED).asked == set(ANSWERS)
    assert "fit:reasons" not in form(RANKED).filled(ANSWERS)


@pytest.mark.parametrize(
    ("field", "value", "named"),
    [
        ("realism:1", "3", "offers no '3' for 'realism:1'"),
        ("realism:1", "", "offers no ''"),
        ("age", "17", "takes no '17' for 'age'"),
        ("fit:reasons", "voice", "offers no 'voice'"),
        ("fit", "1", "does not ask the question 'fit'"),
    ],
)
def test_what_a_person_could_not_answer_is_named(field: str, value: str, named: str) -> None:
    with pytest.raises(IncompleteFormError, match=named):
        form(RANKED).filled({**ANSWERS, field: (value,)})


def test_a_question_the_study_does_not_know_is_named() -> None:
    with pytest.raises(IncompleteFormError, match="asks age, comment, which"):
        form(RANKED).filled({"realism:1": ("1",)})


def test_boxes_that_must_be_ticked_are_ticked_and_others_are_not() -> None:
    html = """<form method="post"><label><input type="checkbox" name="agree" required> Yes</label>
      <label><input type="checkbox" name="newsletter"> News</label>
      <input type="submit" value="Go"></form>"""
    assert form(html).filled({}) == {"agree": ["on"]}


def test_a_disabled_button_does_not_count() -> None:
    with pytest.raises(IncompleteFormError, match="no button"):
        form(RANKED.replace("<button>", "<button disabled>")).filled(ANSWERS)


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        (' aria-label="Rank of A"', "'realism:1'"),
        ("Age", "'age'"),
        (' for="age"', "'age'"),
        (" the face", "'fit:reasons'"),
        ("Anything else?", "'comment'"),
        ("Next", "its button"),
    ],
)
def test_a_field_or_button_without_words_is_named(lost: str, named: str) -> None:
    with pytest.raises(IncompleteFormError, match=f"has no words beside {named}"):
        form(RANKED.replace(lost, "")).filled(ANSWERS)


def test_what_a_script_shows_gets_its_words_from_the_script() -> None:
    hidden = '<div hidden><button type="button"></button></div>'
    form(RANKED.replace("<button>", f"{hidden}<button>")).filled(ANSWERS)
