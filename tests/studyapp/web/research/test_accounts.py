"""Logging in and out: cookies, session fixation, redirects, and messages."""

import logging
import re
from dataclasses import replace

import pyotp
import pytest
from flask import Flask

from studyapp.database.engine import Database
from studyapp.researchers.credentials import MAX_ATTEMPTS_PER_NAME
from studyapp.researchers.links import first_owner_link
from studyapp.web.research.page import COOKIE
from studyapp.web.site import attach, client_address, site_of
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import LOGIN, ResearchBrowser
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.taking_part_steps import SetClock

NAME = COOKIE.name("tiny")
COMMON = {"password": "password1234", "again": "password1234"}


def test_the_first_owner_needs_the_printed_link(
    app: Flask, stored: Database, clock: SetClock, browser: ResearchBrowser
) -> None:
    address = f"/research/join/{first_owner_link(stored, clock)}"
    fields = {"name": "Ada", "password": PASSWORD, "again": PASSWORD}
    assert "an owner" in browser.get(address).heading
    for refused in ({"again": "another one entirely"}, COMMON):
        assert browser.post(address, **fields | refused).status_code == 422

    assert browser.post(address, **fields).status_code == 303

    assert browser.get("/research/").heading == "Progress"
    again = ResearchBrowser(app).get(address, status=404)
    assert "this link does not work" in again.text.casefold()


def with_cookie(app: Flask, token: str) -> ResearchBrowser:
    """Return another browser that has a cookie with `token`."""
    browser = ResearchBrowser(app)
    browser.client.set_cookie(NAME, token, path="/research")
    return browser


def test_logging_in_sets_a_new_cookie_and_logging_out_revokes_it(log_in: LogIn) -> None:
    log_in("owner")
    planted = "p" * 43
    browser = with_cookie(log_in.app, planted)

    response = browser.log_in("Ada")

    parts = response.headers["Set-Cookie"].split("; ")[1:]
    assert sorted(parts) == ["HttpOnly", "Path=/research", "SameSite=Lax"]
    token = browser.cookies[NAME]
    # Another study on this host has a cookie of another name.
    assert COOKIE.name("other") != NAME
    assert token != planted
    assert with_cookie(log_in.app, planted).client.get("/research/").status_code == 303
    assert with_cookie(log_in.app, token).client.get("/research/").status_code == 200
    assert browser.post("/research/log-out").location == LOGIN
    assert with_cookie(log_in.app, token).client.get("/research/").status_code == 303
    assert browser.cookies[NAME] != token


def test_refused_logins_get_the_same_message_until_there_are_too_many(
    browser: ResearchBrowser, log_in: LogIn
) -> None:
    log_in("owner")
    wrong, unknown = browser.log_in("Ada", "wrong wrong wrong"), browser.log_in("Eve", PASSWORD)
    assert wrong.status_code == unknown.status_code == 403
    assert wrong.text.replace("Ada", "") == unknown.text.replace("Eve", "")
    assert list(wrong.headers.keys()) == list(unknown.headers.keys())

    for _ in range(MAX_ATTEMPTS_PER_NAME):
        browser.log_in("Ada", "wrong")
    refused = browser.log_in("Ada")

    assert (refused.status_code, refused.headers["Retry-After"]) == (429, "900")
    assert "15 minutes" in refused.text


def test_attempts_behind_a_proxy_are_counted_per_client(
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


def invited(owner: ResearchBrowser) -> str:
    """Invite a viewer, and return the link as its page shows it."""
    page = PageReader(owner.post("/research/researchers/invite", role="viewer").text)
    return page.value("a[href*='/research/join/']", "href")


def test_no_secret_is_logged(
    browser: ResearchBrowser,
    log_in: LogIn,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.DEBUG)
    owner = log_in("owner")
    link = invited(owner)
    browser.get(link)
    browser.log_in("Ada", "a wrong secret phrase")
    # A failure of ours.
    monkeypatch.setattr("studyapp.web.research.accounts.find_link", lambda *_: 1 / 0)
    log_in.app.config["PROPAGATE_EXCEPTIONS"] = False

    assert "ZeroDivisionError" not in browser.get(link, status=500).text

    assert "ZeroDivisionError" in caplog.text
    token = link.rpartition("/")[2]
    for secret in (PASSWORD, "a wrong secret phrase", token, *owner.cookies.values()):
        assert secret not in caplog.text


def test_a_changed_password_takes_effect(log_in: LogIn) -> None:
    viewer, elsewhere = log_in("viewer"), log_in("viewer")
    new = "seven quiet bicycles"
    fields = {"old": PASSWORD, "password": new, "again": new}

    for refused in ({"old": "x"}, {"again": "x"}, COMMON):
        assert viewer.post("/research/account", **(fields | refused)).status_code == 422
    assert viewer.post("/research/account", **fields).status_code == 303

    assert "has been changed" in viewer.get("/research/account?changed=").text
    assert elsewhere.client.get("/research/").status_code == 303
    assert ResearchBrowser(log_in.app).log_in("Mary").status_code == 403
    assert ResearchBrowser(log_in.app).log_in("Mary", new).status_code == 303


@pytest.mark.parametrize("origin", ["https://study.example.org", ""])
def test_a_requests_host_header_appears_in_no_link(log_in: LogIn, origin: str) -> None:
    owner = log_in("owner")
    attach(log_in.app, replace(site_of(log_in.app), origin=origin))
    owner.client.environ_base["HTTP_HOST"] = "evil.example.com"

    assert re.fullmatch(rf"{origin}/research/join/[\w-]+", invited(owner))


ADDRESS = "/research/account/second-factor"


def test_a_researcher_turns_on_the_second_factor_and_logs_in_with_a_code(log_in: LogIn) -> None:
    browser = log_in("owner")
    page = browser.get(ADDRESS)
    secret = page.value("[name=secret]", "value")
    # Scanners need dark squares on white, also on a dark page.
    assert page.soup.select("svg path[fill='white'], svg path[fill='#fff']")
    assert "style=" not in str(page.soup.select("svg")[0])
    code = pyotp.TOTP(secret).at(log_in.clock.now())

    right = {"secret": secret, "code": code, "password": PASSWORD}
    for wrong in ({"secret": "short"}, {"password": "wrong"}, {"code": "000000"}):
        refused = browser.post(ADDRESS, **right | wrong)
        assert refused.status_code == 422
    assert PageReader(refused.text).value("[name=secret]", "value") == secret

    done = browser.post(ADDRESS, **right)

    recovery = re.findall(r"<code>([a-z2-7-]{19})</code>", done.text)
    assert len(recovery) == 8
    assert "code of your device" in browser.get("/research/account").text
    other = ResearchBrowser(log_in.app)
    assert browser.post(f"{ADDRESS}/off", password="wrong").status_code == 422  # noqa: S106
    assert other.log_in("Ada").status_code == 403
    assert other.log_in("Ada", code=recovery[0]).status_code == 303
    assert browser.post(f"{ADDRESS}/off", password=PASSWORD).status_code == 303
    assert ResearchBrowser(log_in.app).log_in("Ada").status_code == 303
