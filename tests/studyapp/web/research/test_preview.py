"""A preview is what a participant sees and stores nothing; a test participation takes no place."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.base import Base
from studyapp.recruitment.invitations import make_test_participation
from studyapp.study.folder import StudyFolder
from studyapp.web.site import site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.studyapp.web.visitor import Visitor
from tests.support.researcher_accounts import joined
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.stored import found_in, opened
from tests.support.studies.taking_part_steps import SetClock

OWN = ("action", "src", "data-watched-url", "data-watched", "data-following", "data-next-batch")
"""What belongs to one participant or address."""

MARK = "This is a test participation"
CHANGED_BY_LOGGING_IN = {"researchers", "researcher_logins", "login_attempts", "audit_lines"}


def open_as_owner(app: Flask) -> tuple[ResearchBrowser, Database]:
    database = site_of(app).database
    joined(database, SetClock(), "Ada")
    browser = ResearchBrowser(app)
    browser.log_in("Ada")
    return browser, database


def rows(database: Database) -> dict[str, int]:
    tables = (t for t in Base.metadata.sorted_tables if t.name not in CHANGED_BY_LOGGING_IN)
    return {table.name: len(found_in(database, select(table))) for table in tables}


def trial_part(page: PageReader) -> str:
    """Return a trial's page without the parts that belong to one participant."""
    main = PageReader(page.text).one("main")
    for tag in main.find_all(True):
        for name in OWN:
            tag.attrs.pop(name, None)
        if tag.get("name") in ("trial", "video"):
            tag.attrs.pop("value", None)
    return str(main)


def test_a_preview_equals_the_participants_page(serve: Serve, clock: SetClock) -> None:
    app = serve(("[conditions.mismatched]", '[conditions.mismatched]\nlabel = "Ours (full)"'))
    browser, _ = open_as_owner(app)
    # Only the list names conditions.
    listed = browser.get("/research/preview").text
    assert "rule based | Ours (full)" in listed or "Ours (full) | rule based" in listed
    participant = Visitor(app, clock).enrol().begin()

    for position, seen in enumerate(participant.take_trials(), start=1):
        previewed = browser.get(f"/research/preview/0/1/{position}/")
        assert trial_part(previewed) == trial_part(seen)
        assert f"Trial {position} of 6 · about" in previewed.one(".progress").get_text()
        assert "Preview: nothing is stored" in previewed.one("header").get_text()
    assert browser.client.get("/research/preview/0/1/7/").status_code == 404


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_trial_of_every_protocol_can_be_previewed(
    serve: Serve, finished_study: Callable[[str], Path], tmp_path: Path, protocol: str
) -> None:
    url = sqlite_url(tmp_path / "walked.db")
    browser, database = open_as_owner(serve(folder=finished_study(protocol), database_url=url))
    before = rows(database)
    listed = browser.get("/research/preview")
    addresses = [str(link["href"]) for link in listed.soup.select("tbody a")]
    assert addresses

    for address, following in zip(addresses, [*addresses[1:], None], strict=True):
        page = browser.get(address)
        for video in page.soup.select("video"):
            part = browser.client.get(
                str(video["src"]), headers={"Range": "bytes=0-9"}, buffered=True
            )
            assert (part.status_code, len(part.data)) == (206, 10)
            report = browser.client.post(
                str(video["data-watched-url"]), json={"batch": 3, "intervals": [[0, 1]]}
            )
            assert report.get_json() == {
                "intervals": json.loads(str(video["data-watched"])),
                "missing": 0.0,
                "next_batch": 4,
                "stored": True,
            }
        style = str(page.soup.select("link[rel=stylesheet]")[0]["href"])
        assert browser.client.get(style, buffered=True).status_code == 200
        sent = browser.client.post(page.action, data={"trial": page.trial})
        assert sent.location == (following or f"/research/preview?{sent.location.split('?')[1]}")
        scripted = browser.client.post(page.action, headers={"Accept": "application/json"})
        assert scripted.get_json() == {"next": sent.location}

    assert rows(database) == before


def test_missing_trials_cannot_be_previewed(app: Flask) -> None:
    browser, _ = open_as_owner(app)
    for rest in (
        *("9/1/1/", "0/0/1/", "0/10000/1/", "0/1/0/", "0/99999999/1/"),
        *("0/1/1/media/0.mp4", "0/1/9/media/1.mp4", "0/1/1/media/..%2f0.mp4"),
        *("0/1/1/static/..%2f..%2f..%2fapp.py", "0/1/1/static/../app.py"),
        *("0/1/1/static/%2e%2e/app.py", "0/1/1/static//etc/passwd"),
    ):
        assert browser.client.get(f"/research/preview/{rest}").status_code == 404, rest
    odd = browser.get("/research/preview?arm=nonsense&place=99999999999")
    assert odd.value("[name=place]", "value") == "1"
    nonsense = browser.client.post("/research/preview/0/1/1/take/preview/watched/1", data=b"\xff")
    assert nonsense.get_json()["next_batch"] == 1


def test_a_test_participation_is_marked_on_every_page_and_takes_no_place(
    log_in: LogIn, serve: Serve, tiny_study: Path
) -> None:
    anybody = log_in.app.test_client()
    assert anybody.get("/try/").status_code == 404
    trial_app = serve(is_test=True)
    assert trial_app.test_client().get("/").status_code == 403
    before = rows(log_in.stored)

    begun = log_in("viewer").post("/research/try").location
    assert begun.startswith("/try/?invitation=")
    assert (MARK in anybody.get(begun).text, MARK in anybody.get("/").text) == (True, False)
    tester = Visitor(trial_app, log_in.clock).enrol(begun.removeprefix("/try/")).begin()
    for page in tester.take_trials():
        assert MARK in page.text
    last = tester.page()
    assert MARK in last.text
    assert last.soup.select("#completion-code")
    assert rows(log_in.stored) == before

    # There is a place for every test, and all are erased together.
    served = site_of(log_in.app).served
    places = sum(arm.places for arm in served.study.arms)
    for _ in range(places):
        token = make_test_participation(tiny_study, served, log_in.clock, by="Ada")
        Visitor(trial_app, log_in.clock).enrol(f"?invitation={token}")
    with opened(StudyFolder(tiny_study).tries) as database:
        assert rows(database)["study_sessions"] == places + 1
        assert log_in("analyst").post("/research/try/erase").status_code == 303
        erased = rows(database)
    assert (erased["study_sessions"], erased["places"]) == (0, 0)
