"""Every page of the desk needs a login, and every form its own origin."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from flask import Flask

from motion.errors import InputError
from studyapp.desk.pages import PAGES
from studyapp.desk.server import open_desk, run_desk
from studyapp.researchers.account import Role
from tests.studyapp.desk.conftest import Joined, Researcher
from tests.studyapp.web.research.research_browser import ResearchBrowser

OPEN_TO_ALL = {page.endpoint for page in PAGES if page.needs is None}
VALUES = {"study": "tiny", "token": "A" * 43, "filename": "viewer.js"}

IN_A_STUDY: dict[Role, set[str]] = {
    "viewer": {
        *("study_page", "open_study_pages", "take_part_as_test", "texts"),
        *("job", "job_archive", "job_file"),
        *("material", "clip_video", "segment_page", "segment_scene"),
    },
    "analyst": {
        *("settings", "save_settings", "start_job", "stop_running_job"),
        *("remove_material", "bring_in", "remove_upload", "take_piece"),
    },
    "owner": {"begin_new_version", "invite_to_study"},
}
"""The pages of a study that each role may open beyond those of the role before."""


def pages(desk: Flask, method: str, below: str = "/research/") -> Iterator[tuple[str, str]]:
    """Yield endpoint and an address of each page of the desk that takes `method`."""
    addresses = desk.url_map.bind("localhost")
    for rule in desk.url_map.iter_rules():
        is_page = rule.rule.startswith(below) and method in (rule.methods or ())
        if is_page and rule.endpoint not in OPEN_TO_ALL:
            values = {name: VALUES.get(name, "1") for name in rule.arguments}
            yield rule.endpoint.rpartition(".")[2], addresses.build(rule.endpoint, values, method)


def test_every_page_needs_a_login(desk: Flask) -> None:
    addresses = [address for _, address in pages(desk, "GET")]
    assert len(addresses) > 10
    for address in (*addresses, "/tiny/research/"):
        answer = desk.test_client().get(address, follow_redirects=True)
        assert answer.request.path == "/research/log-in", address


def test_forms_from_other_sites_are_refused(desk: Flask, ada: ResearchBrowser) -> None:
    addresses = [address for _, address in pages(desk, "POST")]
    assert len(addresses) > 10
    for address in addresses:
        assert ada.client.post(address).status_code == 403, address
        sent = ada.client.post(
            address, data={"form_code": ada.code()}, headers={"Sec-Fetch-Site": "cross-site"}
        )
        assert sent.status_code == 403, address


@pytest.mark.parametrize("role", IN_A_STUDY)
def test_each_role_in_a_study_opens_its_pages_and_no_others(
    desk: Flask, ada: ResearchBrowser, joined: Joined, role: Role
) -> None:
    roles = list(IN_A_STUDY)
    allowed = set().union(*(IN_A_STUDY[each] for each in roles[: roles.index(role) + 1]))
    browser = joined(role)
    opened = set()
    for method in ("GET", "POST"):
        for endpoint, address in pages(desk, method, "/research/studies/<study>/"):
            if endpoint in ("take_over", "study_link", "use_study_link"):
                continue
            answer = browser.post(address) if method == "POST" else browser.client.get(address)
            answer.close()
            if answer.status_code != 403:
                opened.add(endpoint)
    assert opened == allowed


@pytest.mark.parametrize(
    ("role", "refused"),
    [("viewer", ("make", "make/study", "researchers")), ("analyst", ("researchers",))],
)
def test_each_role_at_the_desk_is_limited_to_its_pages(
    researcher: Researcher, role: Role, refused: tuple[str, ...]
) -> None:
    researcher("Ada")
    browser = researcher("Grace", role)
    for page in ("make", "make/study", "researchers"):
        answer = browser.client.get(f"/research/{page}?template=pairwise")
        assert (answer.status_code == 403) is (page in refused), page
    answer = browser.post("/research/make/study", template="pairwise")
    assert (answer.status_code == 403) is ("make/study" in refused)


def test_an_unservable_desk_is_refused_and_its_database_is_private(
    tmp_path: Path, tiny_study_template: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="this is a study"):
        run_desk(tiny_study_template, "127.0.0.1", 1)
    with pytest.raises(InputError, match=r"cannot listen there \((?!Unknown)"):
        run_desk(tmp_path, "no host", 1)
    monkeypatch.setattr(socket, "has_dualstack_ipv6", lambda: False)
    with pytest.raises(InputError, match="cannot listen there"):
        run_desk(tmp_path, "no:host", 1)
    open_desk(tmp_path).database.close()
    assert (tmp_path / "desk.db").stat().st_mode & 0o077 == 0
    monkeypatch.setenv("DATABASE_URL", "postgresql://somewhere/else")
    with pytest.raises(InputError, match="own folder"):
        run_desk(tmp_path, "127.0.0.1", 1)
