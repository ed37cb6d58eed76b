"""Pages are read as they were served; what a person could not use is named."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from studyapp.rehearsal.pages import BrokenPageError, Page

TRIAL = """
<h1>Trial 7 of 30</h1>
<form method="post" action="/withdraw"><button>Stop</button></form>
<video id="pair" src="/media/t0ken.mp4" data-duration="5.2" data-watched-url="/watched/7"></video>
<form method="post" id="answers" action="/answer">
  <input type="hidden" name="trial" value="abc">
  <input type="hidden" name="csrf_token" value="xyz">
  <label><input type="radio" name="rhythm" value="-1"> slightly A</label>
  <label><input type="radio" name="rhythm" value="0"> no difference</label>
  <select name="realism:1" aria-label="Rank of A"><option value="">choose …</option>
    <option value="1">1</option><option value="2">2</option></select>
  <label for="age">Age</label> <input type="number" id="age" name="age" min="18" max="99">
  <label><input type="checkbox" name="fit:reasons" value="hands"> the hands</label>
  <label><input type="checkbox" name="fit:reasons" value="face"> the face</label>
  <label><input type="checkbox" name="agree" required> Yes</label>
  <span id="said">Anything else?</span> <textarea name="comment" aria-labelledby="said"></textarea>
  <div hidden><button type="button"></button></div>
  <button form="unplayable" name="skip" value="yes">Go on without this video</button>
</form>
<form method="post" id="unplayable"></form>
<button form="answers" name="go" value="next">Next</button>
"""

ANSWERS = {"rhythm": ("-1",), "realism:1": ("2",), "age": ("31",), "comment": ("–",)}


def trial(html: str = TRIAL) -> Page:
    return Page("http://study.test/p/trial", html)


def fill(page: Page, answers: Mapping[str, tuple[str, ...]]) -> dict[str, list[str]]:
    return page.fill(page.answer_form, answers)


def test_a_form_is_filled_with_answers_and_all_that_a_browser_sends_along() -> None:
    page, answers = trial(), {**ANSWERS, "fit:reasons": ("hands", "face")}

    assert page.target(page.answer_form) == "http://study.test/answer"
    assert fill(page, answers) == {
        "trial": ["abc"],
        "csrf_token": ["xyz"],
        "agree": ["on"],
        "go": ["next"],
        **{name: list(values) for name, values in answers.items()},
    }


def test_boxes_may_stay_empty_and_everything_else_waits_for_an_answer() -> None:
    assert trial().answer_form.questions == set(ANSWERS)
    assert "fit:reasons" not in fill(trial(), ANSWERS)
    with pytest.raises(BrokenPageError, match="asks age, comment, rhythm, which"):
        fill(trial(), {"realism:1": ("1",)})


@pytest.mark.parametrize(
    ("field", "value", "named"),
    [
        ("realism:1", "3", "does not offer '3' for 'realism:1'"),
        ("realism:1", "", "does not offer ''"),
        ("rhythm", "2", "does not offer '2' for 'rhythm'"),
        ("age", "17", "does not accept '17' for 'age'"),
        ("fit:reasons", "voice", "does not offer 'voice'"),
        ("fit", "1", "does not ask the question 'fit'"),
    ],
)
def test_what_a_person_could_not_answer_is_named(field: str, value: str, named: str) -> None:
    with pytest.raises(BrokenPageError, match=named):
        fill(trial(), {**ANSWERS, field: (value,)})


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ('<button form="answers" name="go" value="next">Next</button>', "no submit button"),
        ('id="answers"', "no form with the id 'answers'"),
        ('name="trial"', "hidden field 'trial'"),
    ],
)
def test_a_form_that_lacks_what_a_person_needs_is_named(lost: str, named: str) -> None:
    with pytest.raises(BrokenPageError, match=named) as caught:
        fill(trial(TRIAL.replace(lost, "")), ANSWERS)

    assert "Trial 7 of 30" in str(caught.value)
    assert "/p/trial" in str(caught.value)


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ("video", "has no video"),
        ('src="/media/t0ken.mp4"', "without src"),
        ('data-duration="5.2"', "without data-duration"),
        ('data-watched-url="/watched/7"', "without data-watched-url"),
    ],
)
def test_a_video_that_cannot_be_watched_is_named(lost: str, named: str) -> None:
    with pytest.raises(BrokenPageError, match=named):
        _ = trial(TRIAL.replace(lost, "")).players


def test_a_completion_code_is_read_from_its_place_alone() -> None:
    assert trial().completion_code is None
    page = Page("http://study.test/done", '<p>Thanks</p><output id="completion-code"> K7 </output>')
    assert page.completion_code == "K7"
    with pytest.raises(BrokenPageError, match="empty completion code"):
        _ = Page("http://study.test/", '<output id="completion-code"></output>').completion_code
