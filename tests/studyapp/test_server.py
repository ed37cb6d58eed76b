from __future__ import annotations

import asyncio
import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest
from gunicorn.config import Config  # type: ignore[import-untyped]

from motion.errors import InputError
from studyapp.database.engine import sqlite_url
from studyapp.rehearsal.server import free_port
from studyapp.web.server import run_server
from studyapp.web.worker import DELAY_SECONDS, REQUEST_SECONDS, StudyWorker
from tests.support.hanging_connections import hanging, slow_body, whole_video
from tests.support.servers.page_scan import seen_videos
from tests.support.servers.study_server import HOST, study_server
from tests.support.servers.visitor import Ledger, Visitor
from tests.support.servers.wire import Wire
from tests.support.studies.fabricated_study import StudyShape, write_fabricated_study

HEAVY = (
    *("torch", "pyrender", "OpenGL", "matplotlib", "librosa", "anny"),
    *("statsmodels", "scipy", "pandas"),
)
"""None is needed to serve a study; each takes long to load, or hundreds of megabytes."""


@pytest.mark.parametrize(
    ("module", "spared"),
    [
        ("studyapp.desk.server", HEAVY),  # which loads the server of a study
        ("studyapp.desk.job_process", (*HEAVY, "flask", "sqlalchemy")),
    ],
)
def test_serving_and_running_jobs_load_nothing_heavy(module: str, spared: tuple[str, ...]) -> None:
    code = f"import json, sys, {module}; print(json.dumps(sorted(sys.modules)))"

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert set(spared) & set(json.loads(done.stdout)) == set()


def test_a_port_in_use_and_an_invalid_proxy_are_reported_before_anything_is_created(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.create_server((HOST, 0)) as taken:
        port = taken.getsockname()[1]

        with pytest.raises(InputError, match=rf"127\.0\.0\.1:{port}: .*--port"):
            run_server(tiny_study, HOST, port, 1)
    monkeypatch.setenv("FORWARDED_ALLOW_IPS", "10.0.0.5, the proxy")
    with pytest.raises(InputError, match=r"FORWARDED_ALLOW_IPS: .*'the proxy'.*10\.0\.0\.5"):
        run_server(tiny_study, HOST, 0, 1)
    assert not (tiny_study / "responses.db").exists()


def test_of_two_servers_started_together_one_gets_the_port(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start(*_: object, **__: object) -> None:
        run_server(tiny_study, HOST, port, 1)

    port = free_port()
    monkeypatch.setattr(
        "studyapp.web.server.open_study", start
    )  # what follows the look at the port

    with pytest.raises(InputError, match=rf"127\.0\.0\.1:{port}: .*--port"):
        start()


@pytest.mark.slow
def test_two_workers_serve_pages_and_stop_soon_on_request(tiny_study: Path) -> None:
    port = free_port()
    code = (
        "import sys; from pathlib import Path; from studyapp.web.server import run_server; "
        f"run_server(Path(sys.argv[1]), '{HOST}', int(sys.argv[2]), 2)"
    )
    server = subprocess.Popen([sys.executable, "-c", code, str(tiny_study), str(port)])
    try:
        with httpx.Client(transport=httpx.HTTPTransport(retries=10)) as client:
            answer = client.get(f"http://{HOST}:{port}/")
            # Not even a proxy on this machine names a path in a header.
            forged = {"SCRIPT_NAME": "/evil", "PATH_INFO": "/evil", "X-Forwarded-Prefix": "/evil"}
            as_before = client.get(f"http://{HOST}:{port}/", headers=forged)
            too_large = client.post(f"http://{HOST}:{port}/", content=bytes(1 << 22))
        assert (answer.status_code, as_before.status_code) == (200, 200)
        assert "I agree" in answer.text
        assert "/evil" not in as_before.text
        assert (too_large.status_code, too_large.headers["Connection"]) == (413, "close")
        assert (tiny_study / "responses.db").exists()
    finally:
        # Some proxies open lines ahead, on which nothing comes.
        with socket.create_connection((HOST, port)):
            server.send_signal(signal.SIGTERM)
            assert server.wait(timeout=REQUEST_SECONDS - 10) == 0


def test_a_worker_quits_even_while_dispatching_a_request() -> None:
    class BusyPool:
        def shutdown(self, **_: object) -> None:
            pytest.fail("the pool's lock is held until the signal has been handled")

    worker = StudyWorker(0, os.getpid(), [], None, 1.0, Config(), None)
    worker.tpool = BusyPool()

    with pytest.raises(SystemExit):
        worker.handle_quit(signal.SIGQUIT, None)
    worker.tmp.close()


@pytest.fixture
def slow_study(tmp_path: Path) -> tuple[Path, Path, str]:
    """Return a fabricated study, its server's log file, and its database's address."""
    write_fabricated_study(tmp_path, StudyShape(places=4, trials=3, practice=0, catch=1))
    return tmp_path, tmp_path / "output", sqlite_url(tmp_path / "bench.db")


@pytest.mark.slow
def test_a_participant_takes_part_while_300_connections_hang(
    slow_study: tuple[Path, Path, str],
) -> None:
    folder, output, url = slow_study
    os.truncate(folder / "video.mp4", 32 << 20)
    ledger = Ledger()

    async def arrive() -> str:
        async with Wire(HOST, server.port) as wire:
            one = Visitor(wire=wire, ledger=ledger, chance=random.Random(1))  # noqa: S311
            return await one.begin(await one.enrol())

    async def take_part() -> None:
        async with Wire(HOST, server.port) as wire, asyncio.timeout(60):
            await Visitor(wire=wire, ledger=ledger, chance=random.Random(2)).take_part()  # noqa: S311

    with study_server(folder, output, database_url=url) as server:
        video = whole_video(seen_videos(asyncio.run(arrive()))[0].source, HOST)
        with (
            hanging(server.port, slow_body("/", HOST), 300, trickle=b"x"),
            hanging(server.port, video, 300),
        ):
            asyncio.run(take_part())

    assert ledger.completed == 1
    assert ledger.errors == []
    assert output.read_text("utf-8") == ""


@pytest.mark.slow
def test_a_participant_who_sends_too_many_reports_waits_longer(
    slow_study: tuple[Path, Path, str],
) -> None:
    folder, output, url = slow_study

    async def flood() -> tuple[float, int]:
        async with Wire(HOST, server.port) as wire, asyncio.timeout(60):
            one = Visitor(wire=wire, ledger=Ledger(), chance=random.Random(1))  # noqa: S311
            address = seen_videos(await one.begin(await one.enrol()))[0].watched_address
            while True:
                started = time.monotonic()
                reply = await wire.post(address, b"", "application/json")
                if reply.status == 429:
                    waited = time.monotonic() - started
                    return waited, (await wire.get("/healthz")).status

    with study_server(folder, output, database_url=url, speed=1.0) as server:
        waited, afterwards = asyncio.run(flood())

    assert waited >= DELAY_SECONDS
    assert afterwards == 200
    assert output.read_text("utf-8") == ""
