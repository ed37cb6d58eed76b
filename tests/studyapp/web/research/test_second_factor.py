from __future__ import annotations

import re

import pyotp
from flask import Flask

from tests.studyapp.researchers_at_hand import PASSWORD
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser

ADDRESS = "/research/account/second-factor"


def test_a_researcher_turns_it_on_by_a_picture_and_logs_in_with_a_code(
    app: Flask, log_in: LogIn, clock: SetClock
) -> None:
    browser = log_in("owner")
    page = browser.get(ADDRESS)
    secret = str(page.one("[name=secret]")["value"])
    assert page.soup.select("svg path")
    assert "style=" not in str(page.soup.select("svg")[0])
    code = pyotp.TOTP(secret).at(clock.now())

    refused = browser.post(ADDRESS, secret=secret, code="000000", password=PASSWORD)
    assert refused.status_code == 422
    done = browser.post(ADDRESS, secret=secret, code=code, password=PASSWORD)

    assert done.status_code == 200
    recovery = re.findall(r"<code>([a-z2-7-]{19})</code>", done.text)
    assert len(recovery) == 8
    assert "code of your device" in browser.get("/research/account").text
    other = ResearchBrowser(app)
    assert other.log_in("Ada").status_code == 403
    assert other.log_in("Ada", code=recovery[0]).status_code == 303
    assert browser.post(f"{ADDRESS}/off", password=PASSWORD).status_code == 303
    assert ResearchBrowser(app).log_in("Ada").status_code == 303
