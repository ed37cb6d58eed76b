"""Every page of the desk asks who comes, and every form where it comes from."""

from __future__ import annotations

from pathlib import Path

import pytest
from flask import Flask
from werkzeug.routing import Rule

from motion.errors import InputError
from studyapp.desk.app import open_desk
from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.desk.pages import PAGES, STUDY_PAGES
from studyapp.desk.server import run_desk
from tests.studyapp.desk.conftest import Researcher

OPEN_TO_ALL = {page.rule for page in PAGES if page.needs is None}


def pages(desk: Flask, method: str) -> list[str]:
    """Return an address of each page of the desk that takes `method`."""
    found = []
    for rule in desk.url_map.iter_rules():
        below = rule.rule.removeprefix("/research")
        is_page = rule.endpoint.startswith("research.") and method in (rule.methods or ())
        if is_page and below not in OPEN_TO_ALL:
            found.append(_address(rule))
    return found


def _address(rule: Rule) -> str:
    values = {"study": "tiny", "token": "A" * 43, "rest": "nowhere"}
    values |= dict.fromkeys(rule.arguments - set(values), "1")
    address = rule.rule
    for name in rule.arguments:
        kind = next(part for part in address.split("<") if part.split(">")[0].endswith(name))
        address = address.replace(f"<{kind.split('>')[0]}>", values[name])
    return address


def test_nobody_comes_in_without_logging_in(desk: Flask) -> None:
    found = pages(desk, "GET")
    assert len(found) > 10
    for page in found:
        answer = desk.test_client().get(page)
        assert answer.status_code == 303, page
        assert answer.headers["Location"].startswith("/research/log-in"), page


def test_no_form_of_another_site_does_anything(desk: Flask, researcher: Researcher) -> None:
    ada = researcher("Ada")
    ada.post("/research/studies/tiny/take-over")
    found = pages(desk, "POST")
    assert len(found) > 10
    for page in found:
        assert ada.client.post(page).status_code == 403, page
        code = ada.code()
        elsewhere = {"Sec-Fetch-Site": "cross-site"}
        sent = ada.client.post(page, data={"form_code": code}, headers=elsewhere)
        assert sent.status_code == 403, page


def test_each_page_of_a_study_needs_a_right_in_it() -> None:
    assert all(page.needs is not None for page in STUDY_PAGES)


def test_too_much_at_once_is_refused(desk: Flask, researcher: Researcher) -> None:
    ada = researcher("Ada")
    ada.post("/research/studies/tiny/take-over")
    text = "#" * 2 * LARGEST_PIECE
    answer = ada.post("/research/studies/tiny/settings", text=text, seen="")
    assert answer.status_code == 413


def test_a_desk_says_what_it_cannot_serve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="no such folder"):
        run_desk(tmp_path / "none", "127.0.0.1", 1)
    monkeypatch.setenv("DATABASE_URL", "postgresql://somewhere/else")
    with pytest.raises(InputError, match="own folder"):
        run_desk(tmp_path, "127.0.0.1", 1)


def test_only_its_owner_reads_the_desks_database(tmp_path: Path) -> None:
    open_desk(tmp_path).database.close()
    assert (tmp_path / "desk.db").stat().st_mode & 0o077 == 0
