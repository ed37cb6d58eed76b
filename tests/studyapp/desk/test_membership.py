"""The desk admits people to a study only after they have shown that they belong to it."""

import errno
import os
import re
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any, NoReturn

import pytest
from flask import Flask

from studyapp.database.engine import Database
from studyapp.desk.lab import Lab, LabStudy
from studyapp.researchers.account import list_accounts, set_access
from studyapp.researchers.links import invite, join, offer_new_password
from studyapp.study.folder import StudyFolder
from tests.studyapp.desk.conftest import Researcher
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.researcher_accounts import PASSWORD

TINY = "/research/studies/tiny/"
INSIDE = "/tiny/research/"


def invited(lab: Lab, tiny: LabStudy) -> str:
    return invite(tiny.database, lab.clock, role="viewer", by="Ada")


def test_an_unowned_study_is_taken_over_once_by_an_owner_of_the_desk(
    tiny: LabStudy, researcher: Researcher
) -> None:
    viewer = researcher("Mary", "viewer")
    assert viewer.post(f"{TINY}take-over").status_code == 403
    assert researcher("Ada").post(f"{TINY}take-over").status_code == 303
    grace = researcher("Grace")
    assert grace.post(f"{TINY}take-over").status_code == 409
    assert [each.name for each in list_accounts(tiny.database)] == ["Ada"]


def test_members_open_a_study_without_another_password_until_they_log_out(
    ada: ResearchBrowser,
) -> None:
    assert "tiny" in ada.get("/research/").text
    answer = ada.post(f"{TINY}open", way="researchers")
    assert answer.headers["Location"] == f"{INSIDE}researchers"
    assert "Ada (you)" in ada.get(f"{INSIDE}researchers").text
    ada.post("/research/log-out")
    assert ada.client.get(INSIDE).status_code == 303


def test_an_owner_of_the_desk_does_not_see_others_studies(
    researcher: Researcher, ada: ResearchBrowser
) -> None:
    grace = researcher("Grace")
    assert "tiny" not in grace.get("/research/").text
    grace.get(TINY, 404)
    assert grace.post(f"{TINY}open").status_code == 404
    assert grace.client.get(INSIDE, follow_redirects=True).status_code == 404


def test_a_damaged_study_is_named_to_owners_and_hides_no_other(
    lab: Lab, tiny: LabStudy, ada: ResearchBrowser, researcher: Researcher
) -> None:
    shutil.copytree(tiny.folder.root, lab.folder / "other")
    with closing(sqlite3.connect(tiny.folder.responses)) as database:
        database.execute("DROP TABLE researchers")
    served_alone = StudyFolder(lab.folder / "alone")
    served_alone.root.mkdir()
    shutil.copyfile(tiny.folder.definition, served_alone.definition)
    served_alone.elsewhere.write_text("postgresql://db/alone", "utf-8")
    page = ada.get("/research/")
    assert "other" in page.text
    assert "The database of tiny cannot be read" in page.text
    assert "The database of alone cannot be read" in page.text
    assert not served_alone.responses.exists()
    assert "restore a backup" in ada.get(TINY, 409).text
    assert "tiny" not in researcher("Mary", "viewer").get("/research/").text


def test_what_the_server_may_not_read_hides_no_other_study(
    lab: Lab, tiny: LabStudy, ada: ResearchBrowser, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(tiny.folder.root, lab.folder / "closed")
    stat = os.stat

    def refuse(path: Any, **_options: Any) -> NoReturn:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    def stat_outside(path: Any, **options: Any) -> os.stat_result:
        return refuse(path) if "/closed/" in str(path) else stat(path, **options)

    monkeypatch.setattr(os, "stat", stat_outside)
    monkeypatch.setattr(Path, "read_text", refuse)
    page = ada.get("/research/")
    assert "tiny" in page.text
    assert "closed" not in page.text


def test_an_owners_link_admits_a_logged_in_member_of_the_desk(
    lab: Lab, tiny: LabStudy, researcher: Researcher, ada: ResearchBrowser
) -> None:
    mary = researcher("Mary", "viewer")
    new_password = offer_new_password(tiny.database, lab.clock, name="Ada", by="Ada")
    assert mary.client.get(f"{TINY}join/{new_password}").status_code == 404
    link = f"{INSIDE}join/{invited(lab, tiny)}"
    answer = mary.client.get(link, follow_redirects=True)
    assert answer.request.path.startswith(f"{TINY}join/")
    assert mary.post(answer.request.path, name="Ada").status_code == 422, "the name is taken"
    assert mary.post(answer.request.path, name="Mary").status_code == 303
    assert "tiny" in mary.get("/research/").text
    assert mary.post(answer.request.path, name="Mary").status_code == 404, "works once"


def test_somebody_is_invited_to_a_study_that_is_being_made(
    tiny: LabStudy, researcher: Researcher, ada: ResearchBrowser
) -> None:
    tiny.folder.root.joinpath("speech", "segments.csv").unlink()
    assert ada.post(f"{TINY}invite", role="king").status_code == 409
    answer = ada.post(f"{TINY}invite", role="analyst")
    link = re.search(rf'href="({TINY}join/[^"]+)"', answer.text)
    assert link is not None
    mary = researcher("Mary", "viewer")
    assert "as an analyst" in mary.get(link[1]).text
    assert mary.post(link[1], name="Mary").status_code == 303
    mary.get(f"{TINY}bring-in")
    assert "Invite somebody" not in mary.get(TINY).text


def shut_out(lab: Lab, database: Database, name: str) -> None:
    (number,) = (each.id for each in list_accounts(database) if each.name == name)
    set_access(database, lab.clock, number, allowed=False, by="Grace")


def test_a_researcher_removed_from_the_desk_loses_its_studies(
    lab: Lab, researcher: Researcher, ada: ResearchBrowser
) -> None:
    ada.post(f"{TINY}open")
    researcher("Grace", "owner")
    shut_out(lab, lab.database, "Ada")
    for address in (INSIDE, "/research/"):
        assert ada.client.get(address).status_code == 303


def test_a_researcher_removed_from_a_study_cannot_return_through_the_desk(
    lab: Lab, tiny: LabStudy, researcher: Researcher, ada: ResearchBrowser
) -> None:
    mary = researcher("Mary", "viewer")
    mary.post(f"{TINY}join/{invited(lab, tiny)}", name="Mary")
    mary.post(f"{TINY}open")
    shut_out(lab, tiny.database, "Mary")
    assert mary.client.get(INSIDE).status_code == 303
    mary.get(TINY, 404)
    again = mary.post(f"{TINY}join/{invited(lab, tiny)}", name="Mary the second")
    assert "your access was removed" in again.text


def test_a_studys_own_login_is_closed_at_a_desk(
    desk: Flask, lab: Lab, tiny: LabStudy, ada: ResearchBrowser
) -> None:
    join(tiny.database, lab.clock, invited(lab, tiny), name="Mary", password=PASSWORD)
    mary = ResearchBrowser(desk)
    fields = {"form_code": mary.code(), "name": "Mary", "password": PASSWORD}
    for method in ("get", "post"):
        answer = getattr(mary.client, method)(f"{INSIDE}log-in", data=fields)
        assert answer.status_code in (303, 403)
    assert mary.client.get(INSIDE).status_code == 303


def test_participants_take_part_below_the_studys_name(desk: Flask) -> None:
    participant = desk.test_client()
    arrived = participant.get("/tiny/", follow_redirects=True)
    assert arrived.request.path.startswith("/tiny/")
    assert arrived.status_code == 200
    unknown = participant.get("/none/")
    assert unknown.status_code == 404
    assert "There is no such page" in unknown.text
    assert participant.get("/tiny").status_code == 200


def test_replacing_a_folder_makes_another_study(
    lab: Lab, desk: Flask, ada: ResearchBrowser
) -> None:
    ada.post(f"{TINY}open")
    ada.get(INSIDE)
    (lab.folder / "tiny").rename(lab.folder / "before")
    shutil.copytree(lab.folder / "before", lab.folder / "tiny")
    for file in (lab.folder / "tiny").glob("responses.db*"):
        file.unlink()
    ada.get(TINY, 404)
    assert ada.client.get(INSIDE).status_code == 303
    ada.get("/research/studies/before/")
