"""Logging in and out: cookies, fixation, where one is led, and what is told to whom."""

from __future__ import annotations

import logging
import re
from dataclasses import replace

import pyotp
import pytest
from flask import Flask
from flask.testing import FlaskClient

from studyapp.database.engine import Database
from studyapp.researchers.attempts import MAX_ATTEMPTS_PER_NAME
from studyapp.researchers.links import first_owner_link
from studyapp.web.research.page import COOKIE
from studyapp.web.site import attach, client_address, site_of
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import LOGIN, ResearchBrowser
from tests.support.researchers_at_hand import PASSWORD
from tests.support.studies.taking_part_steps import SetClock

NAME = COOKIE.name("tiny")


def test_the_first_owner_comes_in_by_the_printed_link_alone(
    app: Flask, stored: Database, clock: SetClock, browser: ResearchBrowser
) -> None:
    token = first_owner_link(stored, clock)
    address = f"/research/join/{token}"
    fields = {"name": "Ada", "password": PASSWORD, "again": PASSWORD}
    assert "an owner" in browser.get(address).heading

    differing = browser.post(address, **(fields | {"again": "another one entirely"}))
    common = browser.post(
        address, **(fields | {"password": "password1234", "again": "password1234"})
    )
    joined = browser.post(address, **fields)
    again = ResearchBrowser(app).client.get(address)

    assert (differing.status_code, common.status_code) == (422, 422)
    assert joined.status_code == 303
    assert browser.get("/research/").heading == "Progress"
    assert again.status_code == 404
    assert "this link does not work" in again.text.casefold()


def test_a_login_gets_a_cookie_that_nobody_has_seen_before(
    log_in: LogIn, browser: ResearchBrowser
) -> None:
    log_in("owner")
    planted = "p" * 43
    browser.client.set_cookie(NAME, planted, path="/research")

    assert browser.log_in("Ada").status_code == 303

    assert browser.cookies[NAME] != planted
    other = ResearchBrowser(browser.client.application)
    other.client.set_cookie(NAME, planted, path="/research")
    assert other.client.get("/research/").status_code == 303


def test_logging_out_makes_the_cookie_worthless(log_in: LogIn) -> None:
    viewer = log_in("viewer")
    token = viewer.cookies[NAME]

    assert viewer.post("/research/log-out").location == LOGIN

    thief = ResearchBrowser(log_in.app)
    thief.client.set_cookie(NAME, token, path="/research")
    assert thief.client.get("/research/").status_code == 303
    assert viewer.cookies[NAME] != token


@pytest.mark.parametrize(("scheme", "prefix"), [("http", ""), ("https", ""), ("https", "/jury")])
def test_the_cookie_is_for_researchers_pages_alone(log_in: LogIn, scheme: str, prefix: str) -> None:
    log_in("owner")
    base = {"wsgi.url_scheme": scheme, "SCRIPT_NAME": prefix}
    client = log_in.app.test_client()
    page = PageReader(client.get(LOGIN, environ_overrides=base).text)
    action = page.action
    assert action == f"{prefix}{LOGIN}"
    code = page.value("main [name=form_code]", "value")

    answer = client.post(
        LOGIN,
        data={"name": "Ada", "password": PASSWORD, "form_code": code},
        environ_overrides=base | {"HTTP_COOKIE": f"{NAME}={cookie_of(client, prefix)}"},
    )

    assert answer.location == f"{prefix}/research/"
    parts = set(answer.headers["Set-Cookie"].split("; ")[1:])
    expected = {"HttpOnly", "SameSite=Lax", f"Path={prefix}/research"}
    assert parts == expected | ({"Secure"} if scheme == "https" else set())


def cookie_of(client: FlaskClient, prefix: str) -> str:
    cookie = client.get_cookie(NAME, path=f"{prefix}/research")
    assert cookie is not None
    return cookie.value


def test_two_studies_on_one_host_do_not_share_a_cookie() -> None:
    assert COOKIE.name("one") != COOKIE.name("other")


LED_TO = [
    ("/research/study-sessions?standing=stale", "/research/study-sessions?standing=stale"),
    ("/research/rehearsal/", "/research/rehearsal/"),
    ("", "/research/"),
    ("https://evil.example/research/", "/research/"),
    ("//evil.example/research/", "/research/"),
    ("/research//evil.example", "/research/"),
    ("/research/\\evil.example", "/research/"),
    ("/research/../take/x", "/research/"),
    ("/research/%2e%2e/", "/research/"),
    ("/research/\r\nSet-Cookie: a=b", "/research/"),
    ("javascript:alert(1)", "/research/"),
    ("/researchers", "/research/"),
    ("/", "/research/"),
    ("/research/log-out", "/research/"),
    ("/research/" + "a" * 600, "/research/"),
]


def test_after_logging_in_one_is_led_to_pages_of_ours_alone(
    browser: ResearchBrowser, log_in: LogIn
) -> None:
    log_in("owner")

    for wanted, led_to in LED_TO:
        assert browser.log_in("Ada", next=wanted).location == led_to, wanted
        answer = browser.client.get(LOGIN, query_string={"next": wanted})
        assert answer.location == led_to, wanted
        browser.post("/research/log-out")


def test_unknown_names_and_wrong_passwords_are_told_the_same(
    browser: ResearchBrowser, log_in: LogIn
) -> None:
    log_in("owner")

    wrong = browser.log_in("Ada", "wrong wrong wrong")
    unknown = browser.log_in("Eve", PASSWORD)

    assert wrong.status_code == unknown.status_code == 403
    assert wrong.text.replace("Ada", "") == unknown.text.replace("Eve", "")
    assert list(wrong.headers.keys()) == list(unknown.headers.keys())


def test_too_many_attempts_are_refused_with_how_long_to_wait(
    browser: ResearchBrowser, log_in: LogIn
) -> None:
    log_in("owner")
    for _ in range(MAX_ATTEMPTS_PER_NAME):
        browser.log_in("Ada", "wrong")

    refused = browser.log_in("Ada")

    assert refused.status_code == 429
    assert refused.headers["Retry-After"] == "900"
    assert "15 minutes" in refused.text


def test_attempts_behind_a_proxy_are_counted_by_who_asks_it(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    def address(peer: str, forwarded: str = "") -> str:
        headers = {"X-Forwarded-For": forwarded} if forwarded else {}
        with app.test_request_context(environ_base={"REMOTE_ADDR": peer}, headers=headers):
            return client_address()

    assert address("192.0.2.7", "198.51.100.1") == "192.0.2.7"
    assert address("127.0.0.1", "6.6.6.6, 198.51.100.1") == "198.51.100.1"
    assert address("127.0.0.1", "nonsense") == "127.0.0.1"
    assert address("2001:db8:1:2:3::4") == address("2001:db8:1:2:9::9") == "2001:db8:1:2::/64"
    assert address("::ffff:192.0.2.7") == "192.0.2.7"
    assert address("") == "unknown"
    monkeypatch.setenv("FORWARDED_ALLOW_IPS", "10.0.0.0/8")
    assert address("10.1.2.3", "198.51.100.1") == "198.51.100.1"
    assert address("127.0.0.1", "198.51.100.1") == "127.0.0.1"


def test_nothing_secret_is_logged(
    browser: ResearchBrowser,
    log_in: LogIn,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.DEBUG)
    owner = log_in("owner")
    link = re.search(
        r"join/([\w-]+)", owner.post("/research/researchers/invite", role="viewer").text
    )
    assert link is not None
    browser.get(f"/research/join/{link[1]}")
    browser.log_in("Ada", "a wrong secret phrase")
    monkeypatch.setattr(
        "studyapp.web.research.own_account.find_link", lambda *_: 1 / 0
    )  # a failure of ours
    log_in.app.config["PROPAGATE_EXCEPTIONS"] = False

    failed = browser.client.get(f"/research/join/{link[1]}")

    assert failed.status_code == 500
    assert "ZeroDivisionError" not in failed.text
    assert "ZeroDivisionError" in caplog.text
    for secret in (PASSWORD, "a wrong secret phrase", link[1], *owner.cookies.values()):
        assert secret not in caplog.text


def test_a_changed_password_is_asked_for_from_then_on(log_in: LogIn) -> None:
    viewer, elsewhere = log_in("viewer"), log_in("viewer")
    new = "seven quiet bicycles"
    fields = {"old": PASSWORD, "password": new, "again": new}

    common = {"password": "password1234", "again": "password1234"}
    for refused in ({"old": "x"}, {"again": "x"}, common):
        assert viewer.post("/research/account", **(fields | refused)).status_code == 422
    assert viewer.post("/research/account", **fields).status_code == 303

    assert "has been changed" in viewer.get("/research/account?changed=").text
    assert elsewhere.client.get("/research/").status_code == 303
    assert ResearchBrowser(log_in.app).log_in("Mary").status_code == 403
    assert ResearchBrowser(log_in.app).log_in("Mary", new).status_code == 303


@pytest.mark.parametrize("origin", ["https://study.example.org", ""])
def test_what_a_request_calls_the_host_stands_in_no_link(log_in: LogIn, origin: str) -> None:
    owner = log_in("owner")
    attach(log_in.app, replace(site_of(log_in.app), origin=origin))
    owner.client.environ_base["HTTP_HOST"] = "evil.example.com"

    page = owner.post("/research/researchers/invite", role="viewer").text

    assert "evil" not in page
    assert re.search(rf'href="{origin}/research/join/[\w-]+"', page)


ADDRESS = "/research/account/second-factor"


def test_a_researcher_turns_it_on_by_a_picture_and_logs_in_with_a_code(log_in: LogIn) -> None:
    browser = log_in("owner")
    page = browser.get(ADDRESS)
    secret = str(page.one("[name=secret]")["value"])
    assert page.soup.select("svg path")
    assert "style=" not in str(page.soup.select("svg")[0])
    code = pyotp.TOTP(secret).at(log_in.clock.now())

    refused = browser.post(ADDRESS, secret=secret, code="000000", password=PASSWORD)
    assert refused.status_code == 422
    done = browser.post(ADDRESS, secret=secret, code=code, password=PASSWORD)

    assert done.status_code == 200
    recovery = re.findall(r"<code>([a-z2-7-]{19})</code>", done.text)
    assert len(recovery) == 8
    assert "code of your device" in browser.get("/research/account").text
    other = ResearchBrowser(log_in.app)
    assert other.log_in("Ada").status_code == 403
    assert other.log_in("Ada", code=recovery[0]).status_code == 303
    assert browser.post(f"{ADDRESS}/off", password=PASSWORD).status_code == 303
    assert ResearchBrowser(log_in.app).log_in("Ada").status_code == 303
