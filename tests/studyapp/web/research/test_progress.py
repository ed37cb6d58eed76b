"""The pages that show how a study goes."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path

from studyapp.database.tables import StudySession
from studyapp.session.form_answers import note_screen_out
from studyapp.session.intake import intake_changes
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.support.studies.taking_part_steps import Participant, taking_part

LIST = "/research/study-sessions"


def test_what_is_counted_leads_to_those_counted_and_names_nobody(
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


def test_study_sessions_are_sorted_by_what_the_head_of_a_column_says(
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
    # Who has reached no check comes last either way.
    failures = viewer.get(page.value("thead a[href*=failures]", "href"))
    assert numbers(failures) == ["1", "2"]
    assert viewer.client.get(f"{LIST}?order=token").status_code == 404


def test_owners_alone_find_and_sort_participants_by_what_a_recruiter_calls_them(
    people: list[Participant], log_in: LogIn
) -> None:
    with log_in.stored.writing() as session:
        session.get_one(StudySession, 2).recruiter_participant = "5d33f9"
    owner, analyst = log_in("owner"), log_in("analyst")
    called, order = f"{LIST}?called=5d33f9", f"{LIST}?order=recruiter"

    assert owner.client.get(called).location == f"{LIST}/2"
    assert "No study session has" in analyst.get(called).text
    for address in (order, f"{LIST}/2"):
        assert "5d33f9" in owner.get(address).text
    for address in (LIST, f"{LIST}/2"):
        assert "5d33f9" not in analyst.get(address).text + log_in("viewer").get(address).text
    assert analyst.client.get(order).status_code == 404


def test_what_happened_leads_to_the_video_it_was_about(
    people: list[Participant], log_in: LogIn
) -> None:
    viewer = log_in("viewer")

    page = viewer.get(f"{LIST}/1")

    links = [str(link["href"]) for link in page.soup.select(".events a[href$='.mp4']")]
    assert len(links) >= 6
    for link in links:
        with closing(viewer.client.get(link)) as answer:
            assert (answer.status_code, answer.mimetype) == (200, "video/mp4"), link
    assert viewer.client.get(f"{LIST}/1/1/9.mp4").status_code == 404


def test_a_rehearsal_is_shown_apart_and_is_not_changed(
    people: list[Participant], log_in: LogIn, tiny_study: Path, empty_sqlite: Path
) -> None:
    viewer, path = log_in("viewer"), tiny_study / "rehearsal.db"
    assert viewer.client.get("/research/rehearsal/").status_code == 404
    path.write_bytes(b"this is not a database" * 100)
    damaged = viewer.get("/research/rehearsal/", status=409)
    assert "Run 'motionjury rehearse' again." in damaged.soup.get_text()
    shutil.copyfile(empty_sqlite, path)
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


def test_no_page_says_what_was_answered(people: list[Participant], log_in: LogIn) -> None:
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

    assert status("state", state="paused") == status("state", state="x", reason="r") == 422
    assert {status("more", more=m, reason="r") for m in ("", "-1", "1e9", "٣")} == {422}
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
