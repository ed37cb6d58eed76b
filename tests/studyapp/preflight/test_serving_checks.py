"""Whether answers can be stored, and videos sent in byte ranges."""

import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import httpx
import pytest

from studyapp.database.tables.study_session import IntakeChange
from studyapp.preflight.material import Material
from studyapp.preflight.serving_checks import address_findings, server_findings, serving_findings
from studyapp.study.folder import StudyFolder
from tests.support.studies.answered_study import answer_study
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import filled, writing


def material(root: Path) -> Material:
    folder = StudyFolder(root)
    return Material.read(folder, folder.study())


def names(root: Path) -> dict[str, str]:
    return {finding.name: finding.what for finding in serving_findings(material(root))}


def test_a_study_that_the_server_refuses_is_found(tiny_study: Path) -> None:
    read_before = material(tiny_study)
    next((tiny_study / "videos").rglob("*.mp4")).unlink()

    (finding,) = server_findings(read_before)

    assert finding.name == "cannot-be-served"


def test_a_study_without_rehearsal_is_found(tiny_study: Path) -> None:
    assert set(names(tiny_study)) == {"not-rehearsed"}
    (tiny_study / "rehearsal.db").touch()
    assert names(tiny_study) == {}


def test_a_file_that_is_no_database_is_found(tiny_study: Path) -> None:
    (tiny_study / "responses.db").write_text("no database at all, but long enough to be read" * 9)

    assert "database-unusable" in names(tiny_study)


def test_participants_a_pause_and_a_changed_design_are_reported(tiny_study: Path) -> None:
    answer_study(tiny_study, people=2)
    found = names(tiny_study)
    assert found["answers-there"] == "2 participants have already arrived"
    assert not {"design-changed", "intake-closed"} & found.keys()

    with writing(tiny_study / "responses.db") as session:
        session.add(filled(IntakeChange, state="paused"))
    redefine(tiny_study, ("\ntrials = 4", "\ntrials = 3"))
    found = names(tiny_study)
    assert found["intake-closed"] == "the study is paused on the researchers' pages"
    assert "design-changed" in found


def test_a_folder_must_be_writable_and_have_space_unless_answers_go_elsewhere(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for free, name in ((0, "disk-full"), (10**9, "disk-short")):
        monkeypatch.setattr(shutil, "disk_usage", lambda _, free=free: SimpleNamespace(free=free))
        assert name in names(tiny_study)
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert "folder-unwritable" in names(tiny_study)
    monkeypatch.setenv("DATABASE_URL", f"sqlite:///{tiny_study / 'elsewhere.db'}")
    assert "folder-unwritable" not in names(tiny_study)


HTTPS = "https://study.example.org/mine"


def server(health: str = "ok\n", ranges: bool = True) -> httpx.MockTransport:
    def respond(request: httpx.Request) -> httpx.Response:
        if request.url.path == "/mine/healthz":
            return httpx.Response(200, text=health)
        if request.url.path != "/mine/static/players.js":
            return httpx.Response(404)
        assert request.headers["Range"] == "bytes=0-9"
        return httpx.Response(206, content=b"0" * 10) if ranges else httpx.Response(200, text="all")

    return httpx.MockTransport(respond)


def request(address: str, transport: httpx.BaseTransport) -> list[str]:
    return [finding.name for finding in address_findings(address, transport=transport)]


def test_only_a_local_address_may_be_unencrypted() -> None:
    assert request("http://study.example.org/mine", server()) == ["address-insecure"]
    assert request("http://localhost/mine", server()) == []


@pytest.mark.parametrize(
    ("transport", "name"),
    [
        (server(health="Welcome to nginx"), "address-other"),
        (httpx.MockTransport(lambda _: httpx.Response(502)), "address-other"),
        (server(ranges=False), "ranges-lost"),
    ],
)
def test_another_server_and_missing_byte_ranges_are_found(
    transport: httpx.BaseTransport, name: str
) -> None:
    assert request(HTTPS, transport) == [name]
