"""Pages are read as they were served; pages that a person could not use are reported."""

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


def fill(answers: Mapping[str, tuple[str, ...]], html: str = TRIAL) -> dict[str, list[str]]:
    """Fill in the form of a trial whose videos play."""
    page = Page("http://study.test/p/trial", html)
    assert page.completion_code is None
    assert [player.duration for player in page.players] == [5.2]
    assert page.target(page.answer_form) == "http://study.test/answer"
    return page.fill(page.answer_form, answers)


def test_a_form_is_submitted_as_by_a_browser() -> None:
    answers = {**ANSWERS, "fit:reasons": ("hands", "face")}

    assert fill(answers) == {
        "trial": ["abc"],
        "csrf_token": ["xyz"],
        "agree": ["on"],
        "go": ["next"],
        **{name: list(values) for name, values in answers.items()},
    }
    assert "fit:reasons" not in fill(ANSWERS)


@pytest.mark.parametrize(
    ("answers", "problem"),
    [
        ({"realism:1": "3"}, "does not offer '3' for 'realism:1'"),
        ({"realism:1": ""}, "does not offer ''"),
        ({"rhythm": "2"}, "does not offer '2' for 'rhythm'"),
        ({"fit:reasons": "voice"}, "does not offer 'voice'"),
        ({"fit": "1"}, "does not ask the question 'fit'"),
        ({}, "asks age, comment, rhythm, which"),
    ],
)
def test_unanswerable_questions_are_named(answers: dict[str, str], problem: str) -> None:
    known = ANSWERS if answers else {"realism:1": ("1",)}
    with pytest.raises(BrokenPageError, match=problem):
        fill({**known, **{field: (value,) for field, value in answers.items()}})


@pytest.mark.parametrize(
    ("lost", "problem"),
    [
        ('<button form="answers" name="go" value="next">Next</button>', "no submit button"),
        ('id="answers"', "no form with the id 'answers'"),
        ('name="trial"', "hidden field 'trial'"),
        ("video", "has no video"),
        ('src="/media/t0ken.mp4"', "without src"),
        ('data-duration="5.2"', "without data-duration"),
        ('data-watched-url="/watched/7"', "without data-watched-url"),
    ],
)
def test_an_incomplete_page_is_reported(lost: str, problem: str) -> None:
    with pytest.raises(BrokenPageError, match=rf"^/p/trial: .*Trial 7 of 30.*{problem}"):
        fill(ANSWERS, TRIAL.replace(lost, ""))


def test_a_completion_code_is_read_only_from_its_element() -> None:
    page = Page("http://study.test/done", '<p>Thanks</p><output id="completion-code"> K7 </output>')
    assert page.completion_code == "K7"
    with pytest.raises(BrokenPageError, match="empty completion code"):
        _ = Page("http://study.test/", '<output id="completion-code"></output>').completion_code
