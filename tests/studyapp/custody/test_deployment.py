"""The files of a server hold only valid values, and the programs that read them accept them."""

import os
import re
import shlex
import shutil
import sqlite3
import subprocess
from collections.abc import Sequence
from contextlib import closing
from datetime import datetime
from itertools import product
from pathlib import Path, PurePosixPath
from typing import Any

import psycopg
import pytest

from motion.errors import InputError
from studyapp.custody.deployment import (
    DATABASES,
    PROXIES,
    DatabaseKind,
    Deployment,
    Proxy,
    deployed_files,
    write_deployment,
)
from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.web.app import LARGEST_REQUEST
from tests.support.servers.throwaway_postgresql import ThrowawayPostgresql

HOSTILE = PurePosixPath("/srv/50%  {x};# of it/%n/my-study")
"""A folder with special characters of every kind of file in its name."""


def deployment(
    proxy: Proxy = "nginx", database: DatabaseKind = "postgresql", prefix: str = "/studies/one"
) -> Deployment:
    return Deployment(
        title='100% "gestures";\n{a} #b $c \\',
        folder=HOSTILE,
        host="study.example.org",
        prefix=prefix,
        proxy=proxy,
        database=database,
        contact="ada@example.org",
    )


ALL = [
    deployment(proxy, database, prefix)
    for proxy, database, prefix in product(PROXIES, DATABASES, ("", "/studies/one"))
]
DESKS = [deployment(proxy, "sqlite", "").model_copy(update={"kind": "desk"}) for proxy in PROXIES]


PLAIN: dict[str, Any] = {
    "title": "Gestures",
    "folder": PurePosixPath("/srv/motionjury/my-study"),
    "host": "study.example.org",
}

REFUSED = {
    "host": [
        *("", "https://study.example.org", "study.example.org/one", "study.example.org:443"),
        *("a b", "study..org", "-a.org", "a-.org", "under_score.org", "study.example.org."),
        *("192.0.2.1", "[2001:db8::1]", "*.example.org", "exämple.org", f"{'a' * 64}.org"),
        *("a.org; }", "a.org\n}", "$host", "a.org{", 'a"b.org', f"{'a.' * 127}org"),
    ],
    "folder": [
        *("my-study", "/srv/../etc", "/srv/a$b", "/srv/a`b`", "/srv/it's", '/srv/"a"/b'),
        *("/srv/a\\b", "/srv/a\nb", "/", "/srv/ü", "/srv/-a", f"/srv/{'a' * 33}"),
        *("/home/ada/my-study", "/root/my-study", "/run/user/1000/my-study"),
    ],
    "contact": ["ada", "a@b@c", "ada@exa mple.org", "a\n@b.org", "}@b.org"],
}


@pytest.mark.parametrize(
    ("field", "value"), [(field, value) for field, values in REFUSED.items() for value in values]
)
def test_values_that_a_file_cannot_hold_are_refused(field: str, value: str) -> None:
    given = PurePosixPath(value) if field == "folder" else value
    with pytest.raises(InputError, match=rf"{field} .*\. (Give|On the server)"):
        Deployment(**PLAIN | {field: given})


def output_of(*command: str | Path, cwd: Path | None = None) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    return f"{done.stdout}{done.stderr}" + (
        f"\nexit status {done.returncode}" if done.returncode else ""
    )


def text_of(study: Deployment, name: str) -> str:
    (text,) = (file.text for file in deployed_files(study) if file.name == name)
    return text


def installed(study: Deployment, into: Path, script: str) -> Deployment:
    """Let a script stand for the program of a server."""
    program = into / "bin" / "motionjury"
    program.parent.mkdir(parents=True)
    program.write_text(f"#!/bin/sh\n{script}", "utf-8")
    program.chmod(0o755)
    return study.model_copy(update={"installed": into})


def needs(program: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(shutil.which(program) is None, reason=f"{program} is not installed")


@pytest.mark.parametrize(
    "study", [*ALL, *DESKS], ids=lambda d: f"{d.kind}-{d.proxy}-{d.database}-{d.prefix}"
)
def test_every_file_is_complete_and_none_forbids_what_pages_need_or_logs_addresses(
    study: Deployment,
) -> None:
    files = deployed_files(study)

    texts = {file.name: file.text for file in files}
    places = [file.place for file in files if file.place]
    assert len(set(places)) == len(places)
    for name, text in texts.items():
        assert text.endswith("\n")
        assert not re.search(r"\{\{|\{%|None|\t\n| \n|X-Frame-Options", text), name
        # Reading sound, librosa and rendering make code while they run.
        assert "MemoryDenyWriteExecute" not in text, name
    if study.proxy == "nginx":
        assert texts["host.nginx"].count("access_log off;") == texts["host.nginx"].count("server {")
    else:
        assert "exclude http.log.error" in texts["Caddyfile"]
    (megabytes,) = re.findall(
        r"(?:client_max_body_size|max_size) (\d+)", texts.get("Caddyfile") or texts["host.nginx"]
    )
    assert int(megabytes) * 1_000_000 >= LARGEST_PIECE + LARGEST_REQUEST


@needs("systemd-analyze")
@pytest.mark.parametrize("study", (ALL[-1], DESKS[0]), ids=lambda d: d.kind)
def test_systemd_finds_no_fault_and_little_exposure(tmp_path: Path, study: Deployment) -> None:
    study = installed(study, tmp_path / "installed", "")
    units = [file for file in deployed_files(study) if "systemd/system" in file.place]
    names = [tmp_path / Path(file.place).name for file in units]
    for file, name in zip(units, names, strict=True):
        name.write_text(file.text, "utf-8")

    output = output_of("systemd-analyze", "verify", "--man=no", *names)

    assert len(units) == 3
    # Messages about other units of this machine do not count.
    assert [line for line in output.splitlines() if str(tmp_path) in line] == []
    for service in (name for name in names if name.suffix == ".service"):
        strict = ["--offline=true", "--threshold=20", "--no-pager"]
        assert "exit status" not in output_of("systemd-analyze", "security", *strict, service)


@needs("systemd-analyze")
def test_the_server_may_start_processes_of_lower_priority() -> None:
    service = text_of(deployment(), "serve.service")
    denied = re.findall(r"^SystemCallFilter=~(.+)$", service, re.MULTILINE)

    for group in " ".join(denied).split():
        assert "setpriority" not in output_of("systemd-analyze", "syscall-filter", group)


@needs("sqlite3")
def test_a_desk_that_cannot_back_up_one_study_backs_up_all_others_and_says_so(
    tmp_path: Path,
) -> None:
    desk = installed(DESKS[0], tmp_path / "installed", 'touch "$3/$2"\n[ "$2" != broken ]\n')
    backups, folder = tmp_path / "motionjury-backups" / desk.name, tmp_path / "desk"
    for name in ("broken", "gestures", "new"):
        (folder / name).mkdir(parents=True)
    for name in ("broken", "gestures"):
        (folder / name / "responses.db").touch()
    with closing(sqlite3.connect(folder / "desk.db")) as accounts:
        accounts.execute("CREATE TABLE account (name)")
    backups.mkdir(parents=True)
    unit = text_of(desk, "backup.service").replace("\\\n", " ")
    (line,) = re.findall(r"^ExecStart=(.+)$", unit, re.MULTILINE)
    command = line.replace("%S", str(tmp_path)).replace("%%", "%").replace("$$", "$")

    done = subprocess.run(shlex.split(command), cwd=folder, check=False)

    assert done.returncode == 1
    accounts_copy = f"desk-{datetime.now().astimezone():%u}.db"
    assert {path.name for path in backups.iterdir()} == {"broken", "gestures", accounts_copy}
    with closing(sqlite3.connect(backups / accounts_copy)) as copy:
        assert copy.execute("SELECT name FROM account").fetchall() == []


@pytest.mark.parametrize("study", (ALL[0], ALL[-1], *DESKS), ids=lambda d: f"{d.kind}-{d.proxy}")
def test_scripts_pass_shellcheck(tmp_path: Path, study: Deployment) -> None:
    write_deployment(study, tmp_path / "out")
    scripts: Sequence[Path] = [tmp_path / "out" / name for name in ("install", "command")]

    for script in scripts:
        assert output_of("sh", "-n", script) == ""
        if shutil.which("shellcheck"):
            assert output_of("shellcheck", script) == ""


@needs("psql")
def test_postgresql_setup_is_idempotent_and_utf_8(
    tmp_path: Path, postgresql: ThrowawayPostgresql
) -> None:
    study = deployment().model_copy(update={"folder": PurePosixPath("/srv/deployed-here")})
    script = tmp_path / "database.sql"
    # The role is another one here: the tests' role exists already, and owns everything.
    text = text_of(study, "database.sql")
    script.write_text(re.sub(r"\bmotionjury\b", "deployed_role", text), "utf-8")
    address = postgresql.url.replace("+psycopg", "")
    try:
        for _run in range(2):
            output = output_of("psql", address, "--set", "ON_ERROR_STOP=1", "--file", script)
            assert "exit status" not in output, output
        with psycopg.connect(address) as connection:
            row = connection.execute(
                "SELECT pg_get_userbyid(datdba), pg_encoding_to_char(encoding), datcollate, "
                "has_database_privilege('public', datname, 'CONNECT') FROM pg_database "
                "WHERE datname = 'motionjury_deployed_here'"
            ).fetchone()
    finally:
        with psycopg.connect(address, autocommit=True) as connection:
            connection.execute("DROP DATABASE IF EXISTS motionjury_deployed_here")
            connection.execute("DROP ROLE IF EXISTS deployed_role")

    assert row == ("deployed_role", "UTF8", "C.UTF-8", False)


def test_files_have_fixed_modes_and_are_never_overwritten(tmp_path: Path) -> None:
    out = tmp_path / "new" / "out"
    before = os.umask(0)
    try:
        files = write_deployment(deployment(PROXIES[0]), out)
    finally:
        os.umask(before)

    modes = {path.name: path.stat().st_mode & 0o777 for path in out.iterdir()}
    assert modes == {file.name: file.mode for file in files}
    assert (modes["environment"], modes["install"], modes["Caddyfile"]) == (0o600, 0o755, 0o644)
    (out / "environment").write_text("PROLIFIC_TOKEN=secret\n", "utf-8")
    with pytest.raises(InputError, match="the folder is not empty"):
        write_deployment(deployment(), out)
    assert (out / "environment").read_text("utf-8") == "PROLIFIC_TOKEN=secret\n"
