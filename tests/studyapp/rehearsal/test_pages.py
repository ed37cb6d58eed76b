from __future__ import annotations

import pytest

from studyapp.rehearsal.pages import BrokenPageError, Page

TRIAL = """
<h1>Trial 7 of 30</h1>
<form method="post" action="/withdraw"><button>Stop</button></form>
<video id="pair" src="/media/t0ken.mp4" data-duration="5.2" data-watched-url="/watched/7"></video>
<form method="post" id="answers" action="/answer">
  <input type="hidden" name="trial" value="abc">
  <input type="hidden" name="csrf_token" value="xyz">
  <fieldset>
    <label><input type="radio" name="rhythm" value="-2"> clearly A</label>
    <label><input type="radio" name="rhythm" value="-1"> slightly A</label>
    <label><input type="radio" name="rhythm" value="0"> no difference</label>
    <label><input type="radio" name="rhythm" value="1"> slightly B</label>
    <label><input type="radio" name="rhythm" value="2"> clearly B</label>
  </fieldset>
  <button type="button" name="replay">Replay</button>
  <button form="unplayable" name="skip" value="yes">Go on without this video</button>
</form>
<form method="post" id="unplayable"></form>
<button form="answers" name="go" value="next">Next</button>
"""


def trial(html: str = TRIAL) -> Page:
    return Page("http://study.test/p/trial", html)


def fill(page: Page, value: str) -> dict[str, list[str]]:
    return page.filled(page.answer_form, {"rhythm": (value,)})


def test_a_form_is_filled_with_what_the_page_sent_along() -> None:
    page = trial()
    assert page.target(page.answer_form) == "http://study.test/answer"
    assert fill(page, "-1") == {
        "trial": ["abc"],
        "csrf_token": ["xyz"],
        "rhythm": ["-1"],
        "go": ["next"],
    }


def test_a_player_is_read_with_its_addresses() -> None:
    (player,) = trial().players
    assert player.source == "http://study.test/media/t0ken.mp4"
    assert player.watched_address == "http://study.test/watched/7"
    assert player.duration == 5.2
    assert "t0ken" in player.token_candidates


def test_all_players_of_a_page_are_read_in_their_order() -> None:
    second = '<video data-duration="2" data-watched-url="/watched/8"><source src="/b.mp4"></video>'
    players = trial(TRIAL + second).players
    assert [player.source.rpartition("/")[2] for player in players] == ["t0ken.mp4", "b.mp4"]


def test_a_form_without_an_action_is_sent_back_to_its_own_page() -> None:
    page = Page("http://study.test/consent", "<form method=post><button>I agree</button></form>")
    assert page.target(page.next_form) == "http://study.test/consent"


def test_a_form_sent_by_get_leads_nowhere() -> None:
    page = Page("http://study.test/", "<form><button>Go</button></form>")
    with pytest.raises(BrokenPageError, match="no form that leads on"):
        _ = page.next_form


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ('name="rhythm"', "does not ask the question 'rhythm'"),
        ('value="-1"', "offers no '-1' for 'rhythm'"),
        ('<button form="answers" name="go" value="next">Next</button>', "no button"),
        ('id="answers"', "no form with the id 'answers'"),
        ('name="trial"', "hidden field 'trial'"),
    ],
)
def test_a_form_that_lacks_what_an_answer_needs_is_named(lost: str, named: str) -> None:
    with pytest.raises(BrokenPageError, match=named) as caught:
        fill(trial(TRIAL.replace(lost, "")), "-1")
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


def test_sounds_are_told_from_the_sound_of_videos() -> None:
    html = """<audio controls src="/sound/x.wav"></audio>
      <audio><source src="/sound/y.wav"></audio>
      <video><source src="/media/v.mp4"></video>"""
    sounds = Page("http://study.test/take/t", html).sounds
    assert sounds == ("http://study.test/sound/x.wav", "http://study.test/sound/y.wav")


def test_a_completion_code_is_read_from_its_place_alone() -> None:
    page = Page("http://study.test/done", '<p>Thanks</p><output id="completion-code"> K7 </output>')
    assert page.completion_code == "K7"
    assert trial().completion_code is None


def test_an_empty_completion_code_is_an_error() -> None:
    page = Page("http://study.test/done", '<output id="completion-code"></output>')
    with pytest.raises(BrokenPageError, match="empty completion code"):
        _ = page.completion_code
