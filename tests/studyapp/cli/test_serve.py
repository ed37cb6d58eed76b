from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from studyapp.cli import serve_command
from studyapp.cli.main import group


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return what a server would be started with; it says that it listens, and ends."""
    given: dict[str, Any] = {}

    def run(*_places: object, on_ready: Callable[[], None], **options: object) -> None:
        given.update(options)
        on_ready()

    monkeypatch.setattr(serve_command, "run_server", run)
    return given


def test_links_begin_where_a_proxy_serves_the_study(
    tiny_study: Path, started: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MOTIONJURY_PREFIX", "/studies/one/")
    monkeypatch.setenv("MOTIONJURY_ADDRESS", "https://study.example.org/studies/one")

    done = CliRunner().invoke(group, ["serve", str(tiny_study)])

    assert done.exit_code == 0
    assert started["prefix"] == "/studies/one/"
    assert "at https://study.example.org/studies/one/ (" in done.output
    assert "at https://study.example.org/studies/one/research/join/" in done.output


def test_without_a_proxy_links_begin_where_the_server_listens(
    tiny_study: Path, started: dict[str, Any]
) -> None:
    done = CliRunner().invoke(group, ["serve", str(tiny_study), "--prefix", "/one"])

    assert "at http://127.0.0.1:8000/one/ (" in done.output


def test_trying_prints_a_link_for_one_test(
    tiny_study: Path, started: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)

    done = CliRunner().invoke(group, ["serve", str(tiny_study), "--prefix", "/one", "--try"])

    assert "as a test at http://127.0.0.1:8000/one/try/?invitation=" in done.output


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
    arguments = ["serve", str(tiny_study), "--prefix", "/one", "--address", address]

    done = CliRunner().invoke(group, arguments)

    assert done.exit_code == 1
    assert said in done.output
    assert not started
