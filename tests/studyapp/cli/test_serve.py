"""`motionjury serve` and `motionjury deploy`: links, and the files of a server."""

from pathlib import Path
from unittest.mock import Mock

import pytest

from studyapp.cli import serve_command
from studyapp.clock import Clock
from studyapp.database.engine import sqlite_url
from studyapp.researchers.account import list_accounts
from studyapp.researchers.links import first_owner_link, join
from tests.support.command_line import refused, run
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.stored import opened


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> Mock:
    """Return a server that reports itself ready and ends."""
    run_server = Mock(side_effect=lambda *_, on_ready, **__: on_ready())
    monkeypatch.setattr(serve_command, "run_server", run_server)
    return run_server


def test_links_start_with_the_public_address_or_the_servers_own(
    tiny_study: Path, started: Mock, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = run("serve", tiny_study, "--address", "http://127.0.0.1:8000/one/", "--try")
    assert "at http://127.0.0.1:8000/one/ (" in output
    assert "as a test at http://127.0.0.1:8000/one/try/?invitation=" in output
    assert "at http://[::1]:8000/ (" in run("serve", tiny_study, "--host", "::1")

    monkeypatch.setenv("MOTIONJURY_ADDRESS", "https://study.example.org/studies/one")
    output = run("serve", tiny_study)
    given = started.call_args.kwargs
    assert (given["prefix"], given["origin"]) == ("/studies/one", "https://study.example.org")
    assert "at https://study.example.org/studies/one/ (" in output
    assert "at https://study.example.org/studies/one/research/join/" in output


@pytest.mark.usefixtures("started")
def test_serving_prints_a_link_until_there_is_an_owner(tiny_study: Path) -> None:
    assert "/research/join/" in run("serve", tiny_study)
    token = run("serve", tiny_study).partition("/research/join/")[2].split()[0]
    with opened(tiny_study / "responses.db") as database:
        join(database, Clock(), token, name="Ada", password=PASSWORD)
        assert [account.role for account in list_accounts(database)] == ["owner"]
        assert first_owner_link(database, Clock()) is None
    assert "Watch the study at http://127.0.0.1:8000/research/." in run("serve", tiny_study)


@pytest.mark.usefixtures("started")
def test_serving_starts_no_empty_database_beside_one_elsewhere(
    tiny_study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DATABASE_URL", sqlite_url(tmp_path / "elsewhere.db"))
    run("serve", tiny_study)
    monkeypatch.delenv("DATABASE_URL")

    message = refused("serve", tiny_study)

    assert "in another database" in message and f"{tmp_path}/elsewhere.db" in message
    assert not (tiny_study / "responses.db").exists()
    (tiny_study / "database.txt").unlink()
    run("serve", tiny_study)


def test_files_of_a_server_are_written_and_listed(tiny_study: Path, tmp_path: Path) -> None:
    out = tmp_path / "server"
    given = ("--host", "study.example.org", "--prefix", "/one", "--proxy", "nginx")
    there = ("--folder-there", "/srv/motionjury/gestures")

    output = run("deploy", tiny_study, *given, *there, "--out", out)

    assert f"{out}/environment: /etc/motionjury/gestures.env (mode 600)" in output
    assert "https://study.example.org/one/" in (out / "environment").read_text("utf-8")
    assert {path.name for path in out.iterdir()} >= {"install", "host.nginx", "Containerfile"}
    unit = (out / "serve.service").read_text("utf-8")
    assert 'serve "/srv/motionjury/gestures" --port 8000' in unit


def test_a_folder_of_studies_gets_the_files_of_a_desk(tiny_study: Path, tmp_path: Path) -> None:
    lab, host = tiny_study.parent, ("--host", "lab.example.org")
    there = ("--folder-there", "/srv/motionjury/lab")

    run("deploy", lab, *host, *there, "--database", "sqlite", "--out", tmp_path / "server")

    unit = (tmp_path / "server" / "serve.service").read_text("utf-8")
    assert 'motionjury desk "/srv/motionjury/lab" --port 8000' in unit
    for option in (("--prefix", "/one"), ("--database", "postgresql")):
        message = refused("deploy", lab, *host, *there, *option, "--out", tmp_path / "none")
        assert f"{option[0]} cannot be given with a desk" in message
