"""Forms that did not come from a page of ours change nothing."""

from __future__ import annotations

from itertools import product

from studyapp.researchers.account import accounts
from studyapp.researchers.links import usable_links
from studyapp.web.research.page import form_code
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import LOGIN, ResearchBrowser
from tests.studyapp.web.research.test_access import MAY, PLACE
from tests.support.researchers_at_hand import PASSWORD

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
    assert usable_links(log_in.stored, log_in.clock.now()) == []
    assert all(account.disabled_at is None for account in accounts(log_in.stored))


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
