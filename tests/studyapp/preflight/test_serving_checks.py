"""Whether answers can be stored, and videos sent piece by piece."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import httpx
import pytest

from studyapp.database.tables import IntakeChange
from studyapp.preflight.material import Material
from studyapp.preflight.serving_checks import address_findings, read_findings, serving_findings
from studyapp.study.folder import StudyFolder
from tests.support.studies.answered_study import answer_study
from tests.support.studies.stored import filled, writing


def material(root: Path) -> Material:
    folder = StudyFolder(root)
    return Material.of(folder, folder.study())


def names(root: Path) -> dict[str, str]:
    return {found.name: found.what for found in serving_findings(material(root))}


def test_a_study_that_the_server_refuses_is_told(tiny_study: Path) -> None:
    looked_at = material(tiny_study)
    next((tiny_study / "videos").rglob("*.mp4")).unlink()

    (found,) = read_findings(looked_at)

    assert found.name == "cannot-be-served"


def test_a_new_study_was_not_rehearsed(tiny_study: Path) -> None:
    assert set(names(tiny_study)) == {"not-rehearsed"}
    (tiny_study / "rehearsal.db").touch()
    assert names(tiny_study) == {}


def test_a_database_that_is_none_is_told(tiny_study: Path) -> None:
    (tiny_study / "responses.db").write_text("no database at all, but long enough to be read" * 9)

    assert "database-unusable" in names(tiny_study)


def test_answers_are_counted_and_a_changed_design_is_told(tiny_study: Path) -> None:
    answer_study(tiny_study, people=2)
    assert names(tiny_study)["answers-there"] == "2 participants have come already"
    assert "design-changed" not in names(tiny_study)
    definition = tiny_study / "study.toml"
    definition.write_text(definition.read_text().replace("trials = 4", "trials = 3", 1))

    assert "design-changed" in names(tiny_study)


def test_a_study_that_was_paused_on_its_pages_is_told(tiny_study: Path) -> None:
    answer_study(tiny_study, people=1)
    assert "intake-closed" not in names(tiny_study)
    with writing(tiny_study / "responses.db") as session:
        session.add(filled(IntakeChange, state="paused"))
    assert names(tiny_study)["intake-closed"] == "the study is paused on the researchers' pages"


@pytest.mark.parametrize(("free", "name"), [(0, "disk-full"), (10**9, "disk-short")])
def test_a_disk_without_room_is_told(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch, free: int, name: str
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=free))

    assert name in names(tiny_study)


def test_a_folder_that_may_not_be_written_is_told_unless_answers_go_elsewhere(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert "folder-unwritable" in names(tiny_study)
    monkeypatch.setenv("DATABASE_URL", f"sqlite:///{tiny_study / 'elsewhere.db'}")
    assert "folder-unwritable" not in names(tiny_study)


HTTPS = "https://study.example.org/mine"


def answering(health: str = "ok\n", ranges: bool = True) -> httpx.MockTransport:
    def respond(request: httpx.Request) -> httpx.Response:
        if request.url.path == "/mine/healthz":
            return httpx.Response(200, text=health)
        if request.url.path != "/mine/static/players.js":
            return httpx.Response(404)
        assert request.headers["Range"] == "bytes=0-9"
        return httpx.Response(206, content=b"0" * 10) if ranges else httpx.Response(200, text="all")

    return httpx.MockTransport(respond)


def asked(address: str, transport: httpx.BaseTransport) -> list[str]:
    return [found.name for found in address_findings(address, transport=transport)]


def test_an_address_without_encryption_is_warned_of_except_on_this_machine() -> None:
    assert asked("http://study.example.org/mine", answering()) == ["address-insecure"]
    assert asked("http://localhost/mine", answering()) == []


@pytest.mark.parametrize(
    ("transport", "name"),
    [
        (answering(health="Welcome to nginx"), "address-other"),
        (httpx.MockTransport(lambda _: httpx.Response(502)), "address-other"),
        (answering(ranges=False), "ranges-lost"),
    ],
)
def test_what_answers_otherwise_is_told(transport: httpx.BaseTransport, name: str) -> None:
    assert asked(HTTPS, transport) == [name]
