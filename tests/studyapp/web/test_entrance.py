"""The pages before enrolment: eligibility, consent, and devices that are sent away."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables.study_session import FormAnswer, StudySession
from studyapp.session.enrolment import Arrival, enrol
from studyapp.session.intake import IntakeState, change_intake
from studyapp.session.refusal import StudyFullError
from studyapp.web.site import site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import is_nobody_stored, stored_in, submit
from tests.support.studies.form_questions import CONSENT, FORM

IPAD = "Mozilla/5.0 (iPad; CPU OS 16_5 like Mac OS X) Version/16.5 Mobile/15E148 Safari/604.1"
ANDROID = "Mozilla/5.0 (Linux; Android 14; Pixel 8) Chrome/126.0 Mobile Safari/537.36"


@pytest.fixture
def asking(serve: Serve) -> Flask:
    """Return the application of a study that asks at the entrance."""
    return serve(added=FORM + CONSENT)


def test_eligibility_comes_before_consent_and_neither_stores_anything(asking: Flask) -> None:
    client = asking.test_client()
    first = PageReader(client.get("/?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=x1").text)
    assert "You will watch" not in first.text

    answer = submit(client, first, adult="yes")
    second = PageReader(answer.text)

    assert answer.status_code == 200
    assert "You will watch" in second.text
    assert all("switch JavaScript on" in page.one("noscript").text for page in (first, second))
    assert second.value("[name=PROLIFIC_PID]", "value") == "p1"
    assert second.value("[name='form:adult']", "value") == "yes"
    assert is_nobody_stored(asking)

    assert submit(client, second, read="yes").status_code == 303
    (known,) = stored_in(asking, select(StudySession))
    names = (known.recruiter_participant, known.recruiter_study, known.recruiter_session)
    assert names == ("p1", "s1", "x1")
    assert list(stored_in(asking, select(FormAnswer.question))) == ["adult", "read"]


def set_intake(app: Flask, state: IntakeState) -> None:
    site = site_of(app)
    change_intake(site.database, site.served, site.clock, state, by="Ada", reason="enough")


def fill_places(app: Flask) -> None:
    """Fill every place."""
    form = {"adult": "yes", "read": "yes"}
    site = site_of(app)
    for visit in "1234":
        enrol(site.database, site.served, Arrival(visit=visit, form=form), site.clock)


@pytest.mark.parametrize(
    ("happens", "words"),
    [
        (partial(set_intake, state="closed"), "The study is over"),
        (partial(set_intake, state="paused"), "paused at the moment"),
        (fill_places, "all the participants it needs"),
    ],
)
def test_a_closed_study_refuses_newcomers_before_any_question_but_not_returners(
    asking: Flask, happens: Callable[[Flask], None], words: str
) -> None:
    client, newcomer = asking.test_client(), asking.test_client()
    before = PageReader(newcomer.get("/").text)
    answers = {"form:adult": "yes", "form:read": "yes"}
    by_window = {"visit": "v" * 32}
    begun = [
        browser.post("/", data=sender | answers).location
        for browser, sender in ((client, {"PROLIFIC_PID": "p1"}), (newcomer, by_window))
    ]
    with suppress(StudyFullError):
        happens(asking)

    for answer in (
        newcomer.get("/"),
        newcomer.get("/consent"),
        newcomer.get("/?PROLIFIC_PID=new"),
        submit(newcomer, before, adult="no"),
    ):
        page = PageReader(answer.text)
        assert (answer.status_code, words in page.heading) == (409, True)
        assert "please return your place there" in page.text
    assert len(stored_in(asking, select(StudySession))) == (4 if happens is fill_places else 2)

    named = client.get("/?PROLIFIC_PID=p1")
    assert "Are you 18 or older?" in named.text
    assert submit(client, PageReader(named.text), adult="yes").location == begun[0]
    # The script fills in the visit that the window remembers, and shows the form.
    form = PageReader(newcomer.get("/").text).one("form#returning")
    assert newcomer.post(str(form["action"]), data=by_window).location == begun[1]
    assert not PageReader(newcomer.get("/?PROLIFIC_PID=new").text).soup.select("#returning")


WINDOWS = "Mozilla/5.0 (Windows NT 10.0) Chrome/126.0"


@pytest.mark.parametrize(
    ("devices", "headers", "is_sent_away"),
    [
        ("", {"User-Agent": ANDROID}, True),
        ("", {"User-Agent": ANDROID, "Sec-CH-UA-Mobile": "?0"}, False),
        ("", {"Sec-CH-UA-Mobile": "?1"}, True),
        ("", {"User-Agent": IPAD}, False),
        ('"computer"', {"User-Agent": IPAD}, True),
        ('"computer"', {"User-Agent": WINDOWS}, False),
        ('"computer", "tablet", "phone"', {"User-Agent": ANDROID}, False),
    ],
)
def test_a_device_is_guessed_from_the_user_agent_until_the_script_measures(
    serve: Serve, devices: str, headers: dict[str, str], is_sent_away: bool
) -> None:
    app = serve(*([("[page]\n", f"[page]\ndevices = [{devices}]\n")] if devices else []))
    page = PageReader(app.test_client().get("/", headers=headers).text)

    assert page.one("#entrance").has_attr("hidden") is is_sent_away
    other = page.soup.select_one("#other-device")
    assert (other is None) is ("phone" in devices)
    assert other is None or other.has_attr("hidden") is not is_sent_away
    assert ("you need a computer." in page.text) is (devices == '"computer"')


@pytest.mark.parametrize(("rule", "words"), [("deleted", "deleted"), ("kept", "kept, but not")])
def test_consent_and_withdrawal_pages_agree_about_the_answers(
    serve: Serve, rule: str, words: str
) -> None:
    client = serve(("[page]\n", f'[page]\nwithdrawn = "{rule}"\n')).test_client()
    consent = PageReader(client.get("/").text)
    address = submit(client, consent).location

    withdrawal_page = client.get(f"{address}/withdraw").text
    done = client.post(f"{address}/withdraw", follow_redirects=True).text

    assert all(words in page for page in (consent.text, withdrawal_page, done))
    assert client.get(f"{address}/withdraw").location == address
