"""Where participants come from: admission, and the way back."""

import re
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import select

from motion.errors import InputError
from studyapp.database.tables.study_session import ScreenOut, StudySession, StudyVersion
from studyapp.database.tables.trial import Trial
from studyapp.recruitment.invitations import make_invitations
from studyapp.web.participants.recruiter_names import COOKIE
from studyapp.web.site import site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor, is_nobody_stored, stored_in, submit
from tests.support.studies.form_questions import COMPREHENSION, FORM
from tests.support.studies.made_study import CODES
from tests.support.studies.taking_part_steps import SetClock

PROLIFIC = '[recruitment]\nchannel = "prolific"\n[recruitment.prolific]\n' + "".join(
    f'{key} = "{code}"\n' for key, code in CODES.items()
)
MTURK = '[recruitment]\nchannel = "mturk"\n'
INVITATIONS = '[recruitment]\nchannel = "invitations"\n'
BY_PROLIFIC = "?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=x1"
BY_MTURK = "?workerId=w1&hitId=h1&assignmentId=a1&turkSubmitTo=https%3A%2F%2Fwww.mturk.com"
PREVIEW = "?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=h1"


def shown_code(page: PageReader) -> str:
    return page.one("#completion-code").get_text(strip=True)


def test_finishing_returns_to_prolific_with_the_code(serve: Serve, clock: SetClock) -> None:
    visitor = Visitor(serve(added=PROLIFIC), clock).enrol(BY_PROLIFIC)
    for page in visitor.begin().take_trials():
        assert all(code not in page.text for code in CODES.values())

    last = visitor.page()
    assert shown_code(last) == CODES["completed"]
    address = f"https://app.prolific.com/submissions/complete?cc={CODES['completed']}"
    assert last.value("#leave", "href") == address
    assert all(CODES[other] not in last.text for other in ("screened_out", "failed_attention"))

    # With another submission in another browser, nothing is left but to return it.
    other = visitor.app.test_client()
    once_more = other.get(f"/{BY_PROLIFIC.replace('x1', 'x2')}")
    refused = submit(other, PageReader(once_more.text))
    assert refused.status_code == 403
    assert all(code not in refused.text for code in CODES.values())
    page = PageReader(refused.text)
    assert "return your place there" in page.text
    assert page.value("#leave", "href") == "https://app.prolific.com"


def test_whoever_finished_by_an_open_link_is_not_asked_to_return_that_place(
    app: Flask, clock: SetClock
) -> None:
    visitor = Visitor(app, clock).enrol("?PROLIFIC_PID=p1")
    assert [*visitor.begin().take_trials()]
    other = app.test_client()
    refused = submit(other, PageReader(other.get("/?PROLIFIC_PID=p1").text))
    assert refused.status_code == 403
    assert "already taken part" in refused.text
    assert "return your place" not in refused.text


def test_failed_attention_checks_are_counted_from_the_answers(
    serve: Serve, clock: SetClock
) -> None:
    app = serve(added=f"{PROLIFIC}[attention]\ntrials = 2\n")
    visitor = Visitor(app, clock).enrol(BY_PROLIFIC)
    page = visitor.begin().page()
    while not page.soup.select("#completion-code"):
        visitor.watch()
        (instructed,) = stored_in(app, select(Trial.instructed).where(Trial.token == page.trial))
        other = "2" if instructed == 1 else "1"
        wrong = {} if instructed is None else {"rhythm": other, "emotion": other}
        assert visitor.post(page, **wrong)[0] == 303
        page = visitor.page()

    assert shown_code(page) == CODES["failed_attention"]
    assert "asked you to choose a particular answer" in page.text


def test_knowing_somebodys_prolific_name_does_not_give_their_study_session(
    serve: Serve, clock: SetClock
) -> None:
    app = serve(added=PROLIFIC)
    owner = Visitor(app, clock).enrol(BY_PROLIFIC)
    stranger = app.test_client()

    answer = submit(stranger, PageReader(stranger.get("/?PROLIFIC_PID=p1").text))

    assert answer.status_code == 403
    assert "another browser" in answer.text
    assert owner.address not in answer.text
    # In a new browser, the link of the same submission shows who it is, in capitals or not.
    same = BY_PROLIFIC.replace("p1", "P1").replace("s1", "s2")
    assert Visitor(app, clock).enrol(same).address == owner.address
    cookie = owner.client.get_cookie(COOKIE.name("tiny"))
    assert cookie is not None
    assert (cookie.http_only, cookie.same_site) == (True, "Lax")


def test_with_signed_links_unsigned_names_are_ignored(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fake_signed_names(signed: str, host: str) -> dict[str, str] | None:
        assert host == "study.example.org"
        return {"PROLIFIC_PID": "P1", "SESSION_ID": "x1"} if signed == "signed" else None

    monkeypatch.setattr("studyapp.web.participants.recruiter_names.signed_names", fake_signed_names)
    app = serve(added=PROLIFIC + 'signed_for = "study.example.org"\n')
    client, stranger = app.test_client(), app.test_client()

    page = PageReader(client.get("/?prolific_token=signed&PROLIFIC_PID=victim").text)
    first = submit(client, page)

    assert first.status_code == 303
    for made_up in (f"/{BY_PROLIFIC}", f"/{BY_PROLIFIC}&prolific_token=made-up"):
        assert client.get(made_up).status_code == 403
    assert stranger.post("/", data={"PROLIFIC_PID": "p1", "SESSION_ID": "x1"}).status_code == 403
    # A new browser, another submission: the signature shows who it is.
    again = PageReader(stranger.get("/?prolific_token=signed").text)
    assert submit(stranger, again).location == first.location
    assert stored_in(app, select(StudySession.recruiter_participant)) == ["p1"]


def test_a_study_without_its_recruiters_codes_is_not_served(serve: Serve) -> None:
    with pytest.raises(InputError, match="no code for"):
        serve(added=PROLIFIC.replace("failed_attention", "# failed_attention"))


OTHER_SITES = (
    *("https://evil.example", "http://www.mturk.com", "https://www.mturk.com.evil.example"),
    *("https://www.mturk.com@evil.example", "https://www.mturk.com/../x", "javascript:alert(1)"),
)


@pytest.mark.parametrize(
    ("channel", "addresses"),
    [
        (PROLIFIC, ["", "?STUDY_ID=s1", "?visit=" + "x" * 30]),
        (INVITATIONS, ["", "?invitation=made-up", BY_PROLIFIC]),
        # Nothing is ever handed in to another site.
        (MTURK, [BY_MTURK.replace("https%3A%2F%2Fwww.mturk.com", site) for site in OTHER_SITES]),
        (MTURK, ["", PREVIEW]),
    ],
    ids=["prolific", "invitations", "other sites", "mturk"],
)
def test_people_without_the_channels_name_are_refused(
    serve: Serve, channel: str, addresses: list[str]
) -> None:
    app = serve(added=channel)
    client = app.test_client()

    for query in addresses:
        names = dict(pair.split("=", 1) for pair in query[1:].split("&") if pair)
        assert client.post("/", data=names).status_code == 403
        if query != PREVIEW:
            assert client.get(f"/{query}").status_code == 403
    assert is_nobody_stored(app)


@pytest.mark.parametrize("name", ["x" * 201, "a%20b", "%E2%80%8B"])
def test_a_malformed_recruiter_name_is_refused(serve: Serve, name: str) -> None:
    answer = serve(added=PROLIFIC).test_client().get(f"/?PROLIFIC_PID={name}")

    assert answer.status_code == 422
    assert "participant ID that cannot be used" in answer.text


def test_a_recruiters_preview_cannot_be_started(serve: Serve) -> None:
    answer = serve(added=MTURK).test_client().get(f"/{PREVIEW}")

    assert answer.status_code == 200
    assert "preview" in answer.text
    assert PageReader(answer.text).soup.select("form, script") == []


def test_screened_out_people_get_the_code_and_cannot_change_their_answer(serve: Serve) -> None:
    app = serve(added=PROLIFIC + FORM)
    client = app.test_client()
    first = PageReader(client.get(f"/{BY_PROLIFIC}").text)
    assert CODES["screened_out"] not in first.text

    answer = submit(client, first, adult="no")

    page = PageReader(answer.text)
    assert page.value("#leave", "href").endswith(f"cc={CODES['screened_out']}")
    assert "only that you were here" in page.text
    for again in (
        answer,
        client.get(f"/{BY_PROLIFIC}"),
        client.get(f"/{BY_PROLIFIC.replace('s1', 's2')}"),
        submit(client, first, adult="yes"),
        client.post("/", data={"PROLIFIC_PID": "p1", "STUDY_ID": "s1", "form:adult": "yes"}),
    ):
        assert again.status_code == 403
        assert shown_code(PageReader(again.text)) == CODES["screened_out"]
    assert stored_in(app, select(ScreenOut.participant)) == ["p1"]
    (version,) = stored_in(app, select(StudyVersion))
    assert (version.screened_by_eligibility, version.screened_by_consent) == (1, 0)
    assert is_nobody_stored(app)


def test_a_worker_comes_back_by_another_assignment_of_the_study(
    serve: Serve, clock: SetClock
) -> None:
    app = serve(added=MTURK)
    first = Visitor(app, clock).enrol(BY_MTURK)
    other = BY_MTURK.replace("h1", "h2").replace("a1", "a2")
    clock.advance(minutes=46)

    again = Visitor(app, clock).enrol(other.replace("w1", "W1"))

    assert again.address == first.address
    list(again.begin().take_trials())
    page = again.page()
    form = page.one("#leave")
    address = "https://www.mturk.com/mturk/externalSubmit"
    assert (form["method"], form["action"]) == ("post", address)
    fields = {str(i["name"]): str(i["value"]) for i in form.select("input")}
    assert fields == {"assignmentId": "a2", "completionCode": shown_code(page)}
    policy = again.client.get(again.address).headers["Content-Security-Policy"]
    assert re.search(r"frame-ancestors( https://\w+\.mturk\.com)+$", policy)
    researchers = app.test_client().get("/research/log-in").headers
    assert researchers["X-Frame-Options"] == "DENY"
    third = again.enrol(other.replace("a2", "a3")).page()
    assert third.value("#leave [name=assignmentId]", "value") == "a2"
    (row,) = stored_in(app, select(StudySession))
    assert (row.recruiter_participant, row.recruiter_study) == ("W1", "h2")


def test_an_invitation_admits_one_person_and_viewing_it_does_not_use_it_up(
    serve: Serve, clock: SetClock
) -> None:
    app = serve(added=INVITATIONS + COMPREHENSION)
    (token,) = make_invitations(site_of(app).database, 1, clock)
    query = f"?invitation={token}"
    for _ in range(3):
        assert app.test_client().get(f"/{query}").status_code == 200
    assert is_nobody_stored(app)

    first = Visitor(app, clock).enrol(query)

    assert Visitor(app, clock).enrol(query).address == first.address
    # People who did not understand the instructions cannot come back by it.
    tries = [submit(first.client, first.page(), judged="the clothes") for _ in range(2)]
    assert [answer.status_code for answer in tries] == [422, 403]
    forged = {"form:judged": "the clothes", "tries": "1"}
    assert first.client.post(f"{first.address}/begin", data=forged).status_code == 404
    assert app.test_client().get(f"/{query}").status_code == 403
    assert stored_in(app, select(StudyVersion.screened_by_comprehension)) == [1]


def test_a_rehearsal_needs_no_recruiter_and_has_no_pages_for_researchers(
    serve: Serve, tmp_path: Path
) -> None:
    database_url = f"sqlite:///{tmp_path / 'rehearsal.db'}"
    app = serve(added=PROLIFIC, rehearsal_speed=10.0, database_url=database_url)

    assert app.test_client().get("/").status_code == 200
    assert app.test_client().get("/research/log-in").status_code == 404
