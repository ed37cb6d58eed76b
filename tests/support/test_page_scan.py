from __future__ import annotations

from tests.support.page_scan import seen_files, seen_form, seen_videos

TRIAL = """
<link rel="stylesheet" href="/static/style.css">
<script type="module" src="/static/trial.js"></script>
<form method="get" action="/elsewhere"></form>
<form method="post" action="/take/me/unplayable" id="unplayable"><input type="hidden" name="trial"
 value="t"></form>
<form method="post" action="/take/me/answers" id="answers">
<input type="hidden" name="trial" value="t&amp;1">
<video src="/media/v.mp4" data-watched-url="/take/me/watched/v" data-duration="2.5"></video>
<input type="radio" name="rhythm" value="-1"><input type="radio" name="rhythm" value="1">
</form>
"""


def test_the_form_with_the_answers_is_found_among_others() -> None:
    form = seen_form(TRIAL)

    assert form is not None
    assert form.is_trial
    assert form.action == "/take/me/answers"
    assert form.hidden == {"trial": "t&1"}
    assert form.choices == {"rhythm": ("-1", "1")}


def test_players_and_files_are_found() -> None:
    (video,) = seen_videos(TRIAL)

    assert (video.source, video.watched_address, video.duration) == (
        "/media/v.mp4",
        "/take/me/watched/v",
        2.5,
    )
    assert seen_files(TRIAL) == ("/static/style.css", "/static/trial.js")


def test_a_page_that_leads_nowhere_has_no_form() -> None:
    assert seen_form("<p>The end.</p>") is None
