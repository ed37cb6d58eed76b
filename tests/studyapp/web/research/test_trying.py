"""A test participation is the whole study, marked, and counts nowhere."""

from __future__ import annotations

from pathlib import Path

from flask import Flask
from sqlalchemy import func, select

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Base, Place, StudySession
from studyapp.recruitment.tries import make_test_participation
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.visitor import Visitor

MARK = "This is a test participation"
CHANGED_BY_LOGGING_IN = {"researchers", "researcher_logins", "login_attempts", "audit_lines"}


def rows(database: Database) -> dict[str, int | None]:
    with database.reading() as session:
        return {
            table.name: session.scalar(select(func.count()).select_from(table))
            for table in Base.metadata.sorted_tables
            if table.name not in CHANGED_BY_LOGGING_IN
        }


def test_a_researcher_takes_part_without_taking_a_place(
    app: Flask, stored: Database, log_in: LogIn, tiny_study: Path
) -> None:
    browser = log_in("viewer")
    before = rows(stored)

    answer = browser.post("/research/try")

    assert answer.status_code == 303
    assert answer.location.startswith("/try/?invitation=")
    consent = app.test_client().get(answer.location)
    assert consent.status_code == 200
    assert MARK in consent.text
    assert MARK not in app.test_client().get("/").text
    assert rows(stored) == before
    assert StudyFolder(tiny_study).tries.exists()


def test_a_test_goes_through_the_whole_study_marked_on_every_page(
    app: Flask, stored: Database, serve: Serve, tiny_study: Path, clock: SetClock
) -> None:
    served = ServedStudy.read(tiny_study)
    token = make_test_participation(tiny_study, served, clock, by="Ada")
    before = rows(stored)
    tester = Visitor(serve(tried=True), clock).enrol(f"?invitation={token}").begin()

    while (page := tester.page()).soup.select("video"):
        assert MARK in page.text
        tester.watch()
        assert tester.post(page)[0] in (200, 303)

    assert MARK in page.text
    assert "code" in page.text
    assert rows(stored) == before


def test_there_is_a_place_for_every_test_and_all_are_erased(
    tiny_study: Path, clock: SetClock, log_in: LogIn, serve: Serve
) -> None:
    served = ServedStudy.read(tiny_study)
    places = sum(arm.places for arm in served.study.arms)
    for _ in range(places + 1):
        token = make_test_participation(tiny_study, served, clock, by="Ada")
        Visitor(serve(tried=True), clock).enrol(f"?invitation={token}")
    database = Database.open(sqlite_url(StudyFolder(tiny_study).tries))
    with database.reading() as session:
        assert session.scalar(select(func.count(StudySession.id))) == places + 1

    assert log_in("analyst").post("/research/try/erase").status_code == 303

    with database.reading() as session:
        assert session.scalar(select(func.count(StudySession.id))) == 0
        assert session.scalar(select(func.count(Place.id))) == 0
    database.close()


def test_without_a_link_there_is_nothing_to_try(app: Flask, serve: Serve) -> None:
    assert app.test_client().get("/try/").status_code == 404
    assert serve(tried=True).test_client().get("/").status_code == 403
