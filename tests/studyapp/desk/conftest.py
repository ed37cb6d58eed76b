"""A desk with one study that is ready, and browsers of its researchers."""

import math
import shutil
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
from flask import Flask

from studyapp.desk.lab import ACCOUNTS, Lab, LabStudy
from studyapp.desk.server import create_desk, open_desk
from studyapp.researchers.account import Role
from studyapp.researchers.audit import event_label, latest_changes
from studyapp.researchers.links import invite
from studyapp.session.enrolment import Arrival, enrol
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.researcher_accounts import joined as join_with_link

Researcher = Callable[..., ResearchBrowser]
Joined = Callable[[Role], ResearchBrowser]


def changes(study: LabStudy) -> list[tuple[str, str, str]]:
    """Return who changed what in the study, the newest first."""
    lines = latest_changes(study.database)
    return [(line.researcher, event_label(line), line.detail) for line in lines]


def first_question(study: LabStudy) -> str:
    """Return the text of the first question that the study serves."""
    served = study.served()
    assert served is not None
    return served.study.questions[0].text


@pytest.fixture(autouse=True)
def studies_are_read_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read changed studies at the next request also on a busy machine."""
    monkeypatch.setattr("studyapp.desk.lab.QUICK_SECONDS", math.inf)


@pytest.fixture
def lab(tmp_path: Path, tiny_study_template: Path, empty_sqlite: Path) -> Iterator[Lab]:
    """Return a desk whose folder contains the study ``tiny``."""
    folder = tmp_path / "lab"
    shutil.copytree(tiny_study_template, folder / "tiny")
    shutil.copyfile(empty_sqlite, folder / "tiny" / "responses.db")
    shutil.copyfile(empty_sqlite, folder / ACCOUNTS)
    lab = open_desk(folder)
    with closing(lab.database):
        yield lab


@pytest.fixture
def tiny(lab: Lab) -> LabStudy:
    """Return the desk's study."""
    study = lab.study("tiny")
    assert study is not None
    return study


@pytest.fixture
def taken(tiny: LabStudy, lab: Lab) -> LabStudy:
    """Return the study after somebody has begun to take part."""
    served = tiny.served()
    assert served is not None
    enrol(tiny.database, served, Arrival(visit="somebody"), lab.clock)
    return tiny


@pytest.fixture
def desk(lab: Lab) -> Flask:
    """Return the desk's application."""
    return create_desk(lab)


@pytest.fixture
def researcher(lab: Lab, desk: Flask) -> Researcher:
    """Return a function that lets somebody join the desk and log in."""

    def browser_of(name: str, role: Role = "owner") -> ResearchBrowser:
        join_with_link(lab.database, lab.clock, name, role)
        browser = ResearchBrowser(desk)
        assert browser.log_in(name).status_code == 303
        return browser

    return browser_of


@pytest.fixture
def ada(researcher: Researcher) -> ResearchBrowser:
    """Return the browser of the study's owner."""
    browser = researcher("Ada")
    browser.post("/research/studies/tiny/take-over")
    return browser


@pytest.fixture
def joined(tiny: LabStudy, lab: Lab, researcher: Researcher) -> Joined:
    """Return a function that lets somebody join the study in a role, and returns their browser."""

    def browser_of(role: Role) -> ResearchBrowser:
        browser = researcher(f"Some {role}", "viewer")
        token = invite(tiny.database, lab.clock, role=role, by="Ada")
        where = f"/research/studies/tiny/join/{token}"
        assert browser.post(where, name=f"Some {role}").status_code == 303
        return browser

    return browser_of
