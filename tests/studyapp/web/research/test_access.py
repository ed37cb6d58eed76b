"""Every page of researchers, for every role and for nobody."""

from __future__ import annotations

import re
from itertools import product

import pytest
from flask import Flask

from studyapp.researchers.account import list_accounts
from studyapp.researchers.links import list_usable_links
from studyapp.web.research.page import form_code
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import LOGIN, ResearchBrowser
from tests.support.researchers_at_hand import PASSWORD

EVERYBODY = {"nobody", "viewer", "analyst", "owner"}
ALL_ROLES = EVERYBODY - {"nobody"}

MAY = {
    ("GET", "/research/log-in"): EVERYBODY,
    ("POST", "/research/log-in"): EVERYBODY,
    ("GET", "/research/join/<token>"): EVERYBODY,
    ("POST", "/research/join/<token>"): EVERYBODY,
    ("POST", "/research/log-out"): ALL_ROLES,
    ("GET", "/research/account"): ALL_ROLES,
    ("POST", "/research/account"): ALL_ROLES,
    ("GET", "/research/account/second-factor"): ALL_ROLES,
    ("POST", "/research/account/second-factor"): ALL_ROLES,
    ("POST", "/research/account/second-factor/off"): ALL_ROLES,
    ("GET", "/research/"): ALL_ROLES,
    ("GET", "/research/rehearsal/"): ALL_ROLES,
    ("GET", "/research/study-sessions"): ALL_ROLES,
    ("GET", "/research/rehearsal/study-sessions"): ALL_ROLES,
    ("GET", "/research/study-sessions/<number>"): ALL_ROLES,
    ("GET", "/research/rehearsal/study-sessions/<number>"): ALL_ROLES,
    ("GET", "/research/study-sessions/<number>/<position>/<video>.mp4"): ALL_ROLES,
    ("GET", "/research/rehearsal/study-sessions/<number>/<position>/<video>.mp4"): ALL_ROLES,
    ("GET", "/research/study-sessions/<number>/<position>/motion"): ALL_ROLES,
    ("GET", "/research/rehearsal/study-sessions/<number>/<position>/motion"): ALL_ROLES,
    ("GET", "/research/study-sessions/<number>/<position>/motion/<scene>"): ALL_ROLES,
    ("GET", "/research/rehearsal/study-sessions/<number>/<position>/motion/<scene>"): ALL_ROLES,
    ("GET", "/research/viewer/<filename>"): ALL_ROLES,
    ("GET", "/research/viewer/avatars/<avatar>"): ALL_ROLES,
    ("GET", "/research/preview/<arm>/<place>/<position>/motion"): ALL_ROLES,
    ("GET", "/research/preview/<arm>/<place>/<position>/motion/<scene>"): ALL_ROLES,
    ("POST", "/research/study-sessions/<number>/exclusion"): {"analyst", "owner"},
    ("GET", "/research/<rest>"): ALL_ROLES,
    ("GET", "/research/changes"): {"analyst", "owner"},
    ("GET", "/research/preview"): ALL_ROLES,
    ("GET", "/research/preview/<arm>/<place>/<position>/"): ALL_ROLES,
    ("GET", "/research/preview/<arm>/<place>/<position>/media/<number>.mp4"): ALL_ROLES,
    ("GET", "/research/preview/<arm>/<place>/<position>/static/<filename>"): ALL_ROLES,
    ("POST", "/research/preview/<arm>/<place>/<position>/take/preview/watched/<number>"): ALL_ROLES,
    ("POST", "/research/preview/<arm>/<place>/<position>/take/preview/<what>"): ALL_ROLES,
    ("POST", "/research/try"): ALL_ROLES,
    ("POST", "/research/try/erase"): {"analyst", "owner"},
    ("GET", "/research/newcomers"): {"analyst", "owner"},
    ("POST", "/research/newcomers/state"): {"analyst", "owner"},
    ("POST", "/research/newcomers/more"): {"analyst", "owner"},
    ("GET", "/research/results"): {"analyst", "owner"},
    ("POST", "/research/results"): {"analyst", "owner"},
    ("GET", "/research/researchers"): {"owner"},
    ("POST", "/research/researchers/invite"): {"owner"},
    ("POST", "/research/links/<link_id>/take-back"): {"owner"},
    ("POST", "/research/researchers/<researcher_id>/password"): {"owner"},
    ("POST", "/research/researchers/<researcher_id>/role"): {"owner"},
    ("POST", "/research/researchers/<researcher_id>/shut-out"): {"owner"},
    ("POST", "/research/researchers/<researcher_id>/let-in"): {"owner"},
}
"""Who may ask for what, written down apart from the code."""

PLACE = re.compile(r"<(?:[^>]*:)?([a-z_]+)>")


def addresses(app: Flask) -> set[tuple[str, str]]:
    """Return every method and address of the application below /research."""
    return {
        (method, PLACE.sub(r"<\1>", rule.rule))
        for rule in app.url_map.iter_rules()
        if rule.rule.startswith("/research")
        for method in (rule.methods or set()) - {"HEAD", "OPTIONS"}
    }


def test_the_table_holds_every_page_there_is(app: Flask) -> None:
    assert addresses(app) == set(MAY)


@pytest.mark.parametrize("who", sorted(EVERYBODY))
def test_everybody_gets_their_pages_and_no_others(
    log_in: LogIn, browser: ResearchBrowser, who: str
) -> None:
    opened = browser if who == "nobody" else log_in(who)
    for (method, rule), allowed in MAY.items():
        if rule == "/research/log-out":
            continue
        address = PLACE.sub("77", rule.replace("<what>", "answers"))
        answer = opened.post(address) if method == "POST" else opened.client.get(address)
        turned_away = answer.status_code == 303 and "/log-in" in answer.location
        not_for_role = answer.status_code == 403 and "not for your role" in answer.text
        assert (turned_away or not_for_role) is (who not in allowed), (method, rule)
        assert turned_away is (who == "nobody" and who not in allowed), (method, rule)
        assert answer.status_code < 500, (method, rule)


def test_a_page_that_the_table_forgets_is_shown_to_nobody(log_in: LogIn) -> None:
    log_in.app.blueprints["research"].name  # noqa: B018 - it is there
    log_in.app.add_url_rule("/research/forgotten", "research.forgotten", lambda: "forgotten")
    owner = log_in("owner")

    assert owner.client.get("/research/forgotten").status_code == 403


POSTS = sorted(rule for method, rule in MAY if method == "POST" and "/preview/" not in rule)


def test_no_form_is_taken_without_its_code(log_in: LogIn) -> None:
    owner = log_in("owner")
    for rule, code in product(POSTS, (None, "", "0" * 64, "ä")):
        fields = {"role": "owner"} | ({} if code is None else {"form_code": code})

        answer = owner.client.post(PLACE.sub("2", rule), data=fields)

        assert answer.status_code == 403, rule
        assert "did not come from a page of this server" in answer.text
    owner.get("/research/")


def test_no_form_is_taken_with_anothers_code_or_from_another_site(log_in: LogIn) -> None:
    owner, other = log_in("owner"), log_in("viewer")
    asked = [("invite", other.code(), "same-origin")]
    asked += [("3/shut-out", owner.code(), site) for site in ("cross-site", "same-site", "none")]

    for address, code, site in asked:
        answer = owner.client.post(
            f"/research/researchers/{address}",
            data={"role": "owner", "form_code": code},
            headers={"Sec-Fetch-Site": site},
        )
        assert answer.status_code == 403
    assert list_usable_links(log_in.stored, log_in.clock.now()) == []
    assert all(account.disabled_at is None for account in list_accounts(log_in.stored))


def test_nobody_can_be_logged_in_from_another_site(log_in: LogIn, browser: ResearchBrowser) -> None:
    log_in("owner")
    fields = {"name": "Ada", "password": PASSWORD}

    without_cookie = log_in.app.test_client().post(LOGIN, data=fields)
    browser.get(LOGIN)
    without_code = browser.client.post(LOGIN, data=fields)
    anothers_code = browser.client.post(LOGIN, data=fields | {"form_code": form_code("x" * 43)})

    for answer in (without_cookie, without_code, anothers_code):
        assert answer.status_code == 403
    assert browser.client.get("/research/").status_code == 303
