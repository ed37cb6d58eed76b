"""Every page of researchers, for every role and for nobody."""

from __future__ import annotations

import re

import pytest
from flask import Flask

from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser

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
