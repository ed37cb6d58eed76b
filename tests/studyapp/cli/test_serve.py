"""`motionjury serve` and `motionjury deploy`: where links begin, and what a server needs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from studyapp.cli import serve_command
from tests.support.command_line import run


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return what a server would be started with; it says that it listens, and ends."""
    given: dict[str, Any] = {}

    def start(*_places: object, on_ready: Callable[[], None], **options: object) -> None:
        given.update(options)
        on_ready()

    monkeypatch.setattr(serve_command, "run_server", start)
    monkeypatch.delenv("DISPLAY", raising=False)
    return given


def test_links_begin_where_a_proxy_serves_the_study(
    tiny_study: Path, started: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MOTIONJURY_PREFIX", "/studies/one/")
    monkeypatch.setenv("MOTIONJURY_ADDRESS", "https://study.example.org/studies/one")

    said = run("serve", tiny_study)

    assert started["prefix"] == "/studies/one/"
    assert "at https://study.example.org/studies/one/ (" in said
    assert "at https://study.example.org/studies/one/research/join/" in said


@pytest.mark.usefixtures("started")
def test_without_a_proxy_links_begin_where_the_server_listens(tiny_study: Path) -> None:
    said = run("serve", tiny_study, "--prefix", "/one", "--try")

    assert "at http://127.0.0.1:8000/one/ (" in said
    assert "as a test at http://127.0.0.1:8000/one/try/?invitation=" in said


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("https://study.example.org/two", "do not fit together"),
        ("study.example.org/one", "not an address of a study"),
        ("https://study.example.org/one?a=b", "not an address of a study"),
        ("ftp://study.example.org/one", "not an address of a study"),
    ],
)
def test_an_address_that_nobody_would_find_is_refused(
    tiny_study: Path, started: dict[str, Any], address: str, said: str
) -> None:
    given = ("--prefix", "/one", "--address", address)
    assert said in run("serve", tiny_study, *given, status=1)
    assert not started


def test_files_of_a_server_are_written_and_their_places_said(
    tiny_study: Path, tmp_path: Path
) -> None:
    out = tmp_path / "server"
    given = ("--host", "study.example.org", "--prefix", "/one", "--proxy", "nginx")
    there = ("--folder-there", "/srv/motionjury/gestures")

    said = run("deploy", tiny_study, *given, *there, "--out", out)

    assert f"{out}/environment: /etc/motionjury/gestures.env (mode 600)" in said
    assert "MOTIONJURY_PREFIX=/one" in (out / "environment").read_text("utf-8")
    assert {path.name for path in out.iterdir()} >= {"install", "host.nginx", "Containerfile"}
    unit = (out / "serve.service").read_text("utf-8")
    assert 'serve "/srv/motionjury/gestures" --port 8000' in unit
