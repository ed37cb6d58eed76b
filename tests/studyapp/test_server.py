import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from gunicorn.config import Config  # type: ignore[import-untyped]

from motion.errors import InputError
from studyapp.database.engine import sqlite_url
from studyapp.rehearsal.server import free_port
from studyapp.web.server import run_server
from studyapp.web.worker import DELAY_SECONDS, REQUEST_SECONDS, StudyWorker
from tests.support.hanging_connections import hanging, slow_body, whole_video
from tests.support.servers.http_participant import HttpParticipant
from tests.support.servers.study_server import HOST, study_server

HEAVY = (
    *("torch", "pyrender", "OpenGL", "matplotlib", "librosa", "anny"),
    *("statsmodels", "scipy", "pandas"),
)
"""None is needed to serve a study; each takes long to load, or hundreds of megabytes."""

BEFORE_TRIALS = 2
"""Pages: consent and instructions."""


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


@pytest.mark.slow
def test_a_participant_takes_part_while_300_connections_hang(
    tiny_study: Path, tmp_path: Path
) -> None:
    for video in tiny_study.glob("videos/**/*.mp4"):
        os.truncate(video, 32 << 20)
    url = sqlite_url(tmp_path / "bench.db")
    with study_server(tiny_study, tmp_path / "output", database_url=url) as server:
        with httpx.Client(base_url=f"http://{HOST}:{server.port}", timeout=60) as client:
            other = HttpParticipant(client, "/", pages=BEFORE_TRIALS)
        with (
            hanging(server.port, slow_body("/", HOST), 300, trickle=b"x"),
            hanging(server.port, whole_video(urlsplit(other.video).path, HOST), 300),
            httpx.Client(base_url=f"http://{HOST}:{server.port}", timeout=60) as client,
        ):
            participant = HttpParticipant(client, "/", pages=BEFORE_TRIALS + 6)

    assert participant.page.soup.select("#completion-code")
    assert (tmp_path / "output").read_text("utf-8") == ""


@pytest.mark.slow
def test_a_participant_who_sends_too_many_reports_waits_longer(
    tiny_study: Path, tmp_path: Path
) -> None:
    url = sqlite_url(tmp_path / "bench.db")
    with (
        study_server(tiny_study, tmp_path / "output", database_url=url, speed=1.0) as server,
        httpx.Client(base_url=f"http://{HOST}:{server.port}", timeout=60) as client,
    ):
        page = HttpParticipant(client, "/", pages=BEFORE_TRIALS).page
        address, status = page.value("video", "data-watched-url"), 0
        while status != 429:
            started = time.monotonic()
            status = client.post(address).status_code
            waited = time.monotonic() - started
        assert client.get("/healthz").status_code == 200

    assert waited >= DELAY_SECONDS
    assert (tmp_path / "output").read_text("utf-8") == ""
