"""The pages that show how a study goes, and on which researchers decide about it."""

from contextlib import closing
from pathlib import Path

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.tables import pseudonyms
from studyapp.results.stored_answers import stored_answers
from studyapp.session.enrolment import Arrival, enrol
from studyapp.session.form_answers import note_screen_out
from studyapp.session.intake import intake_changes
from studyapp.study.folder import StudyFolder
from studyapp.web.site import site_of
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.read_once import read_once
from tests.support.studies.taking_part_steps import Participant, taking_part

LIST = "/research/study-sessions"


def test_counts_link_to_their_sessions_without_names(
    people: list[Participant], log_in: LogIn
) -> None:
    viewer = log_in("viewer")
    assert "screened out" not in viewer.get("/research/").text
    for name in ("p1", "p1", "p2"):
        note_screen_out(log_in.stored, name, "eligibility", log_in.clock)

    page = viewer.get("/research/")

    assert page.words(".truth") == (
        "1 of 4 places done 1 active 0 stale 2 open Too few have finished recently for a forecast"
    )
    links = [str(link["href"]) for link in page.soup.select("#live a")]
    assert len(links) > 6
    for link in links:
        number = page.soup.select(f'#live a[href="{link}"]')[0].get_text().split()[0]
        assert viewer.get(link).words("p[role=status]").startswith(f"{number} study session"), link
    assert "2 people were screened out before the trials: 2 by the questions about" in page.text
    assert "p1" not in page.text
    curve = page.one(".completions svg")
    assert curve["aria-label"] == "1 of 4 places are done."
    assert len(str(curve.select("polyline")[1]["points"]).split()) > 2


def test_study_sessions_are_sorted_by_column_heading(
    people: list[Participant], log_in: LogIn
) -> None:
    viewer = log_in("viewer")
    page = viewer.get(LIST)

    def numbers(page: PageReader) -> list[str]:
        return [row.get_text() for row in page.soup.select("tbody th")]

    assert numbers(page) == ["2", "1"]
    assert page.one("th[aria-sort]").get_text(" ", strip=True) == "Number ↓"
    longest = viewer.get(page.value("thead a[href*=duration]", "href"))
    shortest = viewer.get(longest.value("thead a[href*=duration]", "href"))
    assert numbers(longest) == numbers(shortest)[::-1] == ["1", "2"]
    assert shortest.value("th[aria-sort]", "aria-sort") == "ascending"
    # Participants who have reached no check come last in either order.
    failures = viewer.get(page.value("thead a[href*=failures]", "href"))
    assert numbers(failures) == ["1", "2"]
    assert viewer.client.get(f"{LIST}?order=token").status_code == 404


def test_only_owners_search_and_sort_by_recruiters_names(
    people: list[Participant], log_in: LogIn
) -> None:
    with log_in.stored.writing() as session:
        session.get_one(StudySession, 2).recruiter_participant = "5d33f9"
    owner, analyst = log_in("owner"), log_in("analyst")
    called, order = f"{LIST}?called=5D33F9", f"{LIST}?order=recruiter"

    assert owner.client.get(called).location == f"{LIST}/2"
    assert "No study session is called" in analyst.get(called).text
    for address in (order, f"{LIST}/2"):
        assert "5d33f9" in owner.get(address).text
    for address in (LIST, f"{LIST}/2"):
        assert "5d33f9" not in analyst.get(address).text + log_in("viewer").get(address).text
    assert analyst.client.get(order).status_code == 404


def test_events_link_to_their_video(people: list[Participant], log_in: LogIn) -> None:
    viewer = log_in("viewer")

    page = viewer.get(f"{LIST}/1")

    links = [str(link["href"]) for link in page.soup.select(".events a[href$='.mp4']")]
    assert len(links) >= 6
    for link in links:
        with closing(viewer.client.get(link)) as answer:
            assert (answer.status_code, answer.mimetype) == (200, "video/mp4"), link
    assert viewer.client.get(f"{LIST}/1/1/9.mp4").status_code == 404


def test_a_rehearsal_is_shown_separately_and_read_only(
    people: list[Participant], log_in: LogIn, tiny_study: Path
) -> None:
    viewer, path = log_in("viewer"), tiny_study / "rehearsal.db"
    assert viewer.client.get("/research/rehearsal/").status_code == 404
    path.write_bytes(b"this is not a database" * 100)
    damaged = viewer.get("/research/rehearsal/", status=409)
    assert "Run 'motionjury rehearse' again." in damaged.soup.get_text()
    path.unlink()
    with taking_part(tiny_study, "rehearsal.db") as simulated:
        simulated.enrol().begin()
    before = path.read_bytes()

    page = viewer.get("/research/rehearsal/")

    assert "simulated" in page.words(".ribbon")
    assert "0 of 4 places done 1 active" in page.words(".truth")
    links = {str(link["href"]).split("?")[0] for link in page.soup.select("#live a")}
    assert links == {"/research/rehearsal/study-sessions"}
    assert "simulated" in viewer.get("/research/rehearsal/study-sessions/1").text
    assert path.read_bytes() == before


def test_no_page_reveals_answers(people: list[Participant], log_in: LogIn) -> None:
    owner = log_in("owner")
    for address in ("/research/", LIST, f"{LIST}/1"):
        text = owner.get(address).words("main").lower()
        for word in ("rhythm", "prefer", "win", "rated"):
            assert word not in text, address


def test_a_study_is_paused_resumed_extended_and_closed_with_reasons(log_in: LogIn) -> None:
    analyst, newcomers = log_in("analyst"), "/research/newcomers"

    def status(what: str, **fields: str) -> int:
        return analyst.post(f"{newcomers}/{what}", **fields).status_code

    def start() -> int:
        return log_in.app.test_client().post("/", data={"visit": "v" * 32}).status_code

    for undecidable in ({"state": "paused"}, {"state": "x", "reason": "r"}):
        assert status("state", **undecidable) == 409
    assert {status("more", more=m, reason="r") for m in ("", "-1", "1001", "1e9", "٣")} == {409}
    assert (status("state", state="paused", reason="a video stalls <b>"), start()) == (303, 409)
    assert (status("state", state="open", reason="it plays"), start()) == (303, 303)
    assert status("more", more="2", reason="two were ill") == 303
    assert status("state", state="closed", reason="enough") == 303

    assert "closed to new participants" in analyst.get("/research/").text
    assert "0 of 6 places done 1 active" in analyst.get("/research/").words(".truth")
    assert "a video stalls <b>" in analyst.get(newcomers).words()
    changes = [
        (change.state, change.more_places, change.researcher)
        for change in intake_changes(log_in.stored)
    ]
    states = [("closed", 2), ("open", 2), ("open", 0), ("paused", 0)]
    assert changes == [(*each, "Charles") for each in states]


ONE = f"{LIST}/1"
SCRIPT = "<script>alert(1)</script>"


def reasons(database: Database) -> list[str]:
    return list(read_once(database, stored_answers).study_sessions["excluded_because"])


def decide(browser: ResearchBrowser, decision: str, reason: str, address: str = ONE) -> int:
    return browser.post(f"{address}/exclusion", decision=decision, reason=reason).status_code


def test_exclusions_and_reinstatements_are_recorded(
    people: list[Participant], log_in: LogIn
) -> None:
    analyst, owner, viewer = log_in("analyst"), log_in("owner"), log_in("viewer")
    participant, address = log_in.app.test_client(), f"/take/{people[0].token}"
    last_page = participant.get(address).text
    assert "No researcher has excluded" in analyst.get(ONE).words("main")
    refused = (("exclude", " "), ("x", "r"), ("reinstate", "r"))
    assert [decide(analyst, *each) for each in refused] == [409] * 3
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


def test_participants_have_the_exports_pseudonyms_except_for_viewers(
    people: list[Participant], log_in: LogIn
) -> None:
    site = site_of(log_in.app)
    arrival = Arrival(recruiter_participant="pid-4711", recruiter_study="one")
    enrol(log_in.stored, site.served, arrival, site.clock)
    # A first export draws the key.
    key = PseudonymKey.read_or_make(StudyFolder(site.folder).pseudonym_key)
    exported = read_once(log_in.stored, pseudonyms, key)
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
        assert "No study session is called" in nobody.text
    StudyFolder(site.folder).pseudonym_key.chmod(0o644)
    assert "must be able to read their key" in analyst.get(LIST).text
