"""Agreement and results so far in a real browser.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.audit import latest_looks
from studyapp.web.site import attach, site_of
from tests.functional.browsing import IN_A_BROWSER, follow, watched_page
from tests.functional.every_page import shown
from tests.functional.joining import NAME, join, link_for_owner
from tests.functional.looking import examination
from tests.support.figures_at_hand import FiguresMeanwhile
from tests.support.studies.answered_study import answer_study

pytestmark = IN_A_BROWSER


def test_results_are_behind_a_reason_and_no_page_on_the_way_has_a_severe_barrier(
    browser: Browser, tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    answer_study(tiny_study, people=4, stop_after=2)
    with (
        examination("research") as examine,
        shown(tiny_study) as (address, app),
        closing(Database.open(sqlite_url(tiny_study / "responses.db"))) as stored,
        watched_page(browser, address) as page,
    ):
        site = site_of(app)
        figures = FiguresMeanwhile(site.folder, site.figures.database_url)
        attach(app, replace(site, figures=figures))
        join(page, link_for_owner(address, stored))
        agreement = page.get_by_role("region", name="Agreement between participants")
        expect(agreement.or_(page.get_by_text("It is being computed")).first).to_be_visible()
        page.get_by_role("link", name="Results", exact=True).press("Enter")
        expect(page.get_by_role("heading", level=1)).to_have_text("Results before the end")
        expect(page.locator("main")).not_to_contain_text("rule based")
        examine(page, "unblind")
        reason = page.get_by_label("Reason, for the log and the report")
        reason.fill("a video broke for two participants")
        reason.press("Enter")
        note = page.get_by_role("note")
        expect(note).to_contain_text("Interim: 3 of 4 participants")
        expect(page.locator("main")).to_contain_text("rule based against mismatched")
        examine(page, "results")
        follow(page.get_by_role("link", name="Overview"))
        expect(page.get_by_role("heading", level=1)).to_have_text("Progress")
        while not agreement.count():
            page.reload()
        expect(agreement).to_contain_text("Rhythm")
        examine(page, "overview-with-agreement")
        [look] = latest_looks(stored)
        assert (look.researcher, look.finished, look.planned) == (NAME, 3, 4)
        closed = replace(site.served, study=site.study.model_copy(update={"open": False}))
        attach(app, replace(site, figures=figures, served=closed))
        follow(page.get_by_role("link", name="Results", exact=True))
        expect(page.get_by_role("heading", level=1)).to_have_text("Results")
        expect(note).to_contain_text("The study is closed: 3 of 4 participants finished")
        examine(page, "results-final")
