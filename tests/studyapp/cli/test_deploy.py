from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from studyapp.cli.main import group


def deploy(*arguments: str | Path) -> tuple[int, str]:
    done = CliRunner().invoke(group, ["deploy", *map(str, arguments)])
    return done.exit_code, done.output


def test_one_file_is_printed_alone(tiny_study: Path) -> None:
    status, said = deploy(tiny_study, "--host", "study.example.org", "--print", "serve.service")

    assert status == 0
    assert said.startswith("[Unit]\n")
    assert f'serve "{tiny_study.resolve()}" --port 8000' in said


def test_all_files_are_written_and_their_places_said(tiny_study: Path, tmp_path: Path) -> None:
    out = tmp_path / "server"
    there = ["--folder-there", "/srv/motionjury/gestures", "--prefix", "/one", "--proxy", "nginx"]

    status, said = deploy(tiny_study, "--host", "study.example.org", "--all", "--out", out, *there)

    assert status == 0
    assert f"{out}/environment: /etc/motionjury/gestures.env (mode 600)" in said
    assert "MOTIONJURY_PREFIX=/one" in (out / "environment").read_text("utf-8")
    assert {path.name for path in out.iterdir()} >= {"install", "host.nginx", "Containerfile"}


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--all"],
        ["--out", "server"],
        ["--print", "install", "--all", "--out", "server"],
    ],
)
def test_it_must_be_said_what_is_wanted(tiny_study: Path, arguments: list[str]) -> None:
    status, said = deploy(tiny_study, "--host", "study.example.org", *arguments)

    assert status == 2
    assert "either --print NAME, or --all with --out FOLDER" in said


def test_a_bad_host_is_one_clear_sentence(tiny_study: Path) -> None:
    status, said = deploy(tiny_study, "--host", "https://study.example.org", "--print", "install")

    assert status == 1
    assert said.startswith("Error: host 'https://study.example.org': this is not a name of a host")
