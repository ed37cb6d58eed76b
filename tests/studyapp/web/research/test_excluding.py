"""Excluding and reinstating participants on the page of their study session; pseudonyms there."""

from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.database.engine import Database
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.tables import pseudonyms
from studyapp.results.stored_answers import stored_answers
from studyapp.session.arrivals import Arrival
from studyapp.session.enrolment import enrol
from studyapp.study.folder import StudyFolder
from studyapp.web.site import site_of
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.read_once import read_once
from tests.support.studies.taking_part_steps import Participant

ONE = "/research/study-sessions/1"
LIST = "/research/study-sessions"
SCRIPT = "<script>alert(1)</script>"


@pytest.fixture
def drawn_key(tiny_study: Path) -> PseudonymKey:
    """Return the key that a first export has drawn."""
    return PseudonymKey.read_or_make(StudyFolder(tiny_study).pseudonym_key)


def reasons(database: Database) -> list[str]:
    return list(read_once(database, stored_answers).study_sessions["excluded_because"])


def decide(browser: ResearchBrowser, decision: str, reason: str, address: str = ONE) -> int:
    return browser.post(f"{address}/exclusion", decision=decision, reason=reason).status_code


def test_an_analyst_excludes_and_an_owner_reinstates_and_all_of_it_can_be_read_later(
    people: list[Participant], log_in: LogIn
) -> None:
    analyst, owner, viewer = log_in("analyst"), log_in("owner"), log_in("viewer")
    participant, address = log_in.app.test_client(), f"/take/{people[0].token}"
    last_page = participant.get(address).text
    assert "No researcher has excluded" in analyst.get(ONE).words("main")
    refused = (("exclude", " "), ("x", "r"), ("reinstate", "r"))
    assert [decide(analyst, *each) for each in refused] == [422] * 3
    assert decide(analyst, "exclude", "r", "/research/rehearsal/study-sessions/1") == 405

    assert decide(analyst, "exclude", SCRIPT) == 303

    page = analyst.get(ONE)
    assert f"Excluded by Charles: {SCRIPT}" in page.words("main")
    assert page.value("main [name=decision]", "value") == "reinstate"
    assert f"Excluded by Charles: {SCRIPT}" in viewer.get(ONE).words("main")
    assert not viewer.get(ONE).soup.select("[name=decision]")
    assert reasons(log_in.stored) == [SCRIPT, ""]
    # Participants are shown nothing of it.
    assert participant.get(address).text == last_page
    assert decide(owner, "reinstate", "it was another one") == 303
    assert reasons(log_in.stored) == ["", ""]
    rows = [
        [cell.get_text().strip() for cell in row.select("td")][1:]
        for row in owner.get(ONE).soup.select("[aria-label='Decisions so far'] tbody tr")
    ]
    assert rows == [
        ["Ada", "excluded", "included", "it was another one"],
        ["Charles", "included", "excluded", SCRIPT],
    ]
    log = owner.get("/research/changes").words("main")
    assert f"participant excluded: study session 1 {SCRIPT}" in log
    assert "participant reinstated: study session 1 it was another one" in log


def test_participants_go_by_the_pseudonyms_of_the_export_except_for_viewers(
    people: list[Participant], log_in: LogIn, drawn_key: PseudonymKey
) -> None:
    site = site_of(log_in.app)
    arrival = Arrival(recruiter_participant="pid-4711", recruiter_study="one")
    enrol(log_in.stored, site.served, arrival, site.clock)
    exported = read_once(log_in.stored, pseudonyms, drawn_key)
    analyst, viewer = log_in("analyst"), log_in("viewer")

    listed = [cell.get_text() for cell in analyst.get(LIST).soup.select("tbody .name")]

    assert listed == [exported[number] for number in "321"]
    for number, name in exported.items():
        assert name in analyst.get(f"{LIST}/{number}").words("main")
        assert name not in viewer.get(f"{LIST}/{number}").text + viewer.get(LIST).text
        for called in (name, f" sub-{name} ", number):
            query = {"called": called}
            found = analyst.client.get(LIST, query_string=query).location
            found_by_viewer = viewer.client.get(LIST, query_string=query).location
            assert found == f"{LIST}/{number}"
            assert found_by_viewer == (found if called == number else None)
    for name in ("p" * 17, "77", "9" * 40, SCRIPT, "٣"):
        nobody = analyst.client.get(LIST, query_string={"called": name})
        assert nobody.status_code == 200
        assert "No study session has the number or pseudonym" in nobody.text
