"""Every page of researchers for every role and without a login, and strangers' input."""

import re
from itertools import product

import pytest
from flask import Flask

from studyapp.database.tables.study_session import FormAnswer, RefusalLine, StudySession
from studyapp.researchers.account import list_accounts
from studyapp.researchers.links import invite, join, list_usable_links
from studyapp.web.research.page import form_code
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import LOGIN, ResearchBrowser
from tests.studyapp.web.visitor import Visitor
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.stored import filled

ROLES = ("nobody", "viewer", "analyst", "owner")

TABLE = """
nobody  GET,POST /log-in
nobody  GET,POST /join/<token>
viewer  POST     /log-out
viewer  GET,POST /account
viewer  GET,POST /account/second-factor
viewer  POST     /account/second-factor/off
viewer  GET      [/rehearsal]/
viewer  GET      [/rehearsal]/study-sessions
viewer  GET      [/rehearsal]/study-sessions/<number>
viewer  GET      [/rehearsal]/study-sessions/<number>/<position>/<video>.mp4
viewer  GET      [/rehearsal]/study-sessions/<number>/<position>/motion
viewer  GET      [/rehearsal]/study-sessions/<number>/<position>/motion/<scene>
viewer  GET      /viewer/<filename>
viewer  GET      /viewer/avatars/<avatar>
viewer  GET      /preview
viewer  GET      /preview/<arm>/<place>/<position>/
viewer  GET      /preview/<arm>/<place>/<position>/media/<number>.mp4
viewer  GET      /preview/<arm>/<place>/<position>/motion
viewer  GET      /preview/<arm>/<place>/<position>/motion/<scene>
viewer  GET      /preview/<arm>/<place>/<position>/static/<filename>
viewer  POST     /preview/<arm>/<place>/<position>/take/preview/watched/<number>
viewer  POST     /preview/<arm>/<place>/<position>/take/preview/<what>
viewer  POST     /try
viewer  GET      /<rest>
analyst POST     /study-sessions/<number>/exclusion
analyst GET      /changes
analyst POST     /try/erase
analyst GET      /newcomers
analyst POST     /newcomers/state
analyst POST     /newcomers/more
analyst GET,POST /results
owner   GET      /researchers
owner   POST     /researchers/invite
owner   POST     /researchers/<researcher_id>/password
owner   POST     /researchers/<researcher_id>/role
owner   POST     /researchers/<researcher_id>/shut-out
owner   POST     /researchers/<researcher_id>/let-in
owner   POST     /links/<link_id>/take-back
"""
"""The lowest role for each page, independent of the code."""

MAY = {
    (method, f"/research{rule}"): set(ROLES[ROLES.index(role) :])
    for role, methods, rules in (line.split() for line in TABLE.split("\n") if line)
    for method in methods.split(",")
    for rule in (re.sub(r"[\[\]]", "", rules), re.sub(r"\[.*\]", "", rules))
}
"""The roles that may ask for each method and address."""

PLACE = re.compile(r"<(?:[^>]*:)?([a-z_]+)>")


def addresses(app: Flask) -> set[tuple[str, str]]:
    """Return every method and address of the application below /research."""
    return {
        (method, PLACE.sub(r"<\1>", rule.rule))
        for rule in app.url_map.iter_rules()
        if rule.rule.startswith("/research")
        for method in (rule.methods or set()) - {"HEAD", "OPTIONS"}
    }


def test_the_rights_table_has_every_page(app: Flask) -> None:
    assert addresses(app) == set(MAY)


@pytest.mark.parametrize("role", ROLES)
def test_each_role_gets_its_pages_and_no_others(
    log_in: LogIn, browser: ResearchBrowser, role: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Packing an avatar takes seconds.
    monkeypatch.setattr("studyapp.web.research.motion_scenes.output_of", lambda *_, **__: b"")
    opened = browser if role == "nobody" else log_in(role)
    for (method, rule), allowed in MAY.items():
        if rule == "/research/log-out":
            continue
        address = PLACE.sub("77", rule.replace("<what>", "answers"))
        answer = opened.post(address) if method == "POST" else opened.client.get(address)
        turned_away = answer.status_code == 303 and "/log-in" in answer.location
        not_for_role = answer.status_code == 403 and "not for your role" in answer.text
        assert (turned_away or not_for_role) is (role not in allowed), (method, rule)
        assert turned_away is (role == "nobody" and role not in allowed), (method, rule)
        assert answer.status_code < 500, (method, rule)


def test_a_page_missing_from_the_table_is_shown_to_nobody(log_in: LogIn) -> None:
    log_in.app.blueprints["research"].name  # noqa: B018 - it is there
    log_in.app.add_url_rule("/research/forgotten", "research.forgotten", lambda: "forgotten")
    owner = log_in("owner")

    assert owner.client.get("/research/forgotten").status_code == 403


POSTS = sorted(rule for method, rule in MAY if method == "POST" and "/preview/" not in rule)


def test_forms_need_their_code_and_their_own_site(log_in: LogIn, browser: ResearchBrowser) -> None:
    owner = log_in("owner")
    anothers = log_in("viewer").code()
    for rule, code in product(POSTS, (None, "", "0" * 64, "ä", anothers)):
        fields = {"role": "owner"} | ({} if code is None else {"form_code": code})
        answer = owner.client.post(PLACE.sub("2", rule), data=fields)
        assert answer.status_code == 403, rule
        assert "did not come from a page of this server" in answer.text
    for site in ("cross-site", "same-site", "none"):
        answer = owner.client.post(
            "/research/researchers/3/shut-out",
            data={"form_code": owner.code()},
            headers={"Sec-Fetch-Site": site},
        )
        assert answer.status_code == 403
    assert list_usable_links(log_in.stored, log_in.clock.now()) == []
    assert all(account.disabled_at is None for account in list_accounts(log_in.stored))
    owner.get("/research/")

    # Nobody can be logged in from another site either.
    login = {"name": "Ada", "password": PASSWORD}
    without_cookie = log_in.app.test_client().post(LOGIN, data=login)
    browser.get(LOGIN)
    without_code = browser.client.post(LOGIN, data=login)
    wrong_code = browser.client.post(LOGIN, data=login | {"form_code": form_code("x" * 43)})
    assert {a.status_code for a in (without_cookie, without_code, wrong_code)} == {403}
    assert browser.client.get("/research/").status_code == 303


SCRIPT = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>"


def test_a_stored_script_is_escaped(log_in: LogIn) -> None:
    owner = log_in("owner")
    token = invite(log_in.stored, log_in.clock, role="viewer", by="Ada")
    join(log_in.stored, log_in.clock, token, name=SCRIPT, password=PASSWORD)
    Visitor(log_in.app, log_in.clock).enrol().begin()
    reason = {"reason": SCRIPT}
    owner.post("/research/study-sessions/1/exclusion", decision="exclude", **reason)
    owner.post("/research/newcomers/more", more="1", **reason)
    with log_in.stored.writing() as session:
        study_session = session.get_one(StudySession, 1)
        study_session.recruiter_participant = study_session.recruiter_study = SCRIPT
        session.add(filled(RefusalLine, study_session_id=1, detail=SCRIPT))
        session.add(filled(FormAnswer, study_session_id=1, stage="closing", value=SCRIPT))

    shown = set()
    pages = {PLACE.sub("1", rule) for method, rule in MAY if method == "GET"}
    for address in {*pages - VIDEOS_AND_FILES, *(f"/research/{odd}{SCRIPT}" for odd in ASKING)}:
        answer = owner.client.get(address, follow_redirects=True)
        assert answer.mimetype == "text/html", address
        page = PageReader(answer.text)
        assert "<script>alert" not in page.text, address
        assert "<img" not in page.text, address
        assert [tag for tag in page.soup.find_all("script") if not tag.get("src")] == [], address
        assert not [tag for tag in page.soup.find_all() for name in tag.attrs if name[:2] == "on"]
        if SCRIPT in page.soup.get_text():
            shown.add(address)
    stored_on = ("changes", "newcomers", "researchers", "study-sessions/1")
    assert {f"/research/{name}" for name in stored_on} <= shown


ASKING = ("", "study-sessions?arm=", "study-sessions?called=", "preview?arm=")

VIDEOS_AND_FILES = {
    "/research/preview/1/1/1/media/1.mp4",
    "/research/preview/1/1/1/static/1",
    "/research/study-sessions/1/1/1.mp4",
    "/research/viewer/avatars/1",
    "/research/rehearsal/study-sessions/1/1/1.mp4",
}

ODD = [
    "/research/../study.toml",
    "/research/%2e%2e/study.toml",
    "/research/..%2f..%2fetc/passwd",
    "/research/rehearsal/../../study.toml",
    "/research/study-sessions/../../responses.db",
    "/research/study-sessions/-1",
    "/research/study-sessions/99999999999999999999",
    "/research/study-sessions/1%00",
    "/research/study-sessions/2147483647",
    "/research/study-sessions?page=99999999999999999999&left_at=-1&standing=done&arm=%00",
    "/research/study-sessions?page=٣&failed=1e9&check=main&_external=1&_scheme=javascript",
    "/research/study-sessions?standing=nonsense",
    "/research/changes?before=0",
    "/research/changes?before=-1",
    "/research/join/..%2f..%2fstudy.toml",
    "/research/join/%00",
    "/research/rehearsal/",
]


def test_malformed_addresses_cause_neither_a_file_nor_a_failure(log_in: LogIn) -> None:
    owner = log_in("owner")
    for address in ODD:
        answer = owner.client.get(address)

        assert answer.status_code in (200, 303, 404), address
        assert "[conditions" not in answer.text
        assert "javascript" not in answer.text
        assert "root:" not in answer.text
        assert "from flask" not in answer.text
    owner.get("/research/account")


def test_a_name_that_cannot_be_stored_is_refused_like_a_wrong_one(browser: ResearchBrowser) -> None:
    for name in ("a\ud800", "x" * 5000, "' OR 1=1 --"):
        sent = name.encode("utf-8", "surrogatepass")
        answer = browser.client.post(
            "/research/log-in", data={"form_code": browser.code(), "name": sent, "password": sent}
        )
        assert answer.status_code == 403
        assert "password or code is wrong" in answer.text
