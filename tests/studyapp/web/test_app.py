"""What the application does for everybody: health, protection, faults, and excess reports."""

import re
import resource
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from flask import Flask, abort
from sqlalchemy.exc import OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from werkzeug.exceptions import default_exceptions

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.web.app import create_app, window_name
from studyapp.web.participants import participant
from studyapp.web.protection import AT_ONCE, KEPT, Pace
from tests.studyapp.web.visitor import WATCHED, Visitor
from tests.support.studies.taking_part_steps import SetClock

WEB = Path(__file__).parents[3] / "studyapp" / "web"


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda stimuli: stimuli[1:], r"stimuli\.json"),
        (lambda stimuli: stimuli.replace("005.mp4", "055.mp4"), r"055\.mp4.*missing.*render"),
        (lambda stimuli: stimuli.replace("take-3", "take-9"), "no video of 'rule_based' .* take-3"),
    ],
    ids=["damaged", "missing", "never rendered"],
)
def test_a_study_that_cannot_be_served_says_why_and_leaves_no_database(
    tiny_study: Path, spoil: Callable[[str], str], words: str
) -> None:
    stimuli = tiny_study / "stimuli.json"
    stimuli.write_text(spoil(stimuli.read_text("utf-8")), "utf-8")

    with pytest.raises(InputError, match=words):
        create_app(tiny_study)
    assert not (tiny_study / "responses.db").exists()


def test_every_response_has_security_headers_and_no_page_is_cached(
    app: Flask, visitor: Visitor
) -> None:
    pages = ("/", "/nowhere", "/take/nobody", visitor.address, "/research/log-in")
    for address in (*pages, "/static/style.css"):
        headers = app.test_client().get(address, buffered=True).headers
        policy = headers["Content-Security-Policy"]
        assert (headers["Referrer-Policy"], headers["X-Frame-Options"]) == ("no-referrer", "DENY")
        assert headers["X-Content-Type-Options"] == "nosniff"
        for rule in ("default-src 'none'", "frame-ancestors 'none'", "form-action 'self'"):
            assert rule in policy
        assert not re.search("unsafe|mturk", policy)
        assert (headers["Cache-Control"] == "no-store") is (address in pages)
        assert ("Set-Cookie" in headers) is ("research" in address)


@pytest.mark.parametrize(
    "template", sorted((WEB / "templates").rglob("*.html")), ids=lambda p: p.name
)
def test_pages_have_no_inline_script_or_style_and_load_nothing_from_other_hosts(
    template: Path,
) -> None:
    text = template.read_text("utf-8")

    assert not re.search(r"<style|\sstyle=|\son[a-z]+=|javascript:|https?://", text)
    assert all("src=" in tag for tag in re.findall(r"<script[^>]*>", text))


def test_the_window_name_does_not_contain_the_address(visitor: Visitor) -> None:
    token = visitor.address.rsplit("/", 1)[1]

    name = visitor.page().value("#elsewhere", "data-window")

    assert name == window_name(token)
    assert not any(name[at : at + 6] in token for at in range(len(name) - 5))


def test_only_server_errors_are_logged_as_such_and_without_the_address(
    app: Flask, caplog: pytest.LogCaptureFixture
) -> None:
    @app.get("/fails/<int:status>/<token>")
    def fails(status: int, token: str) -> str:
        if status == 500:
            raise ZeroDivisionError
        abort(status)

    for status in default_exceptions:
        answer = app.test_client().get(f"/fails/{status}/s3cret")
        assert answer.status_code == status
        assert ("went wrong on our side" in answer.text) == (status >= 500), status
        assert re.search(r"(is|are) stored|is lost|[Gg]o back", answer.text), status
        assert "ZeroDivisionError" not in answer.text
    assert "ZeroDivisionError" in caplog.text
    assert "s3cret" not in caplog.text


def test_while_the_database_is_down_pages_ask_to_try_again(
    app: Flask, caplog: pytest.LogCaptureFixture
) -> None:
    gone = OperationalError("SELECT token", {"token": "secret"}, Exception("gone\nmore"), True)
    errors = iter([gone, PoolTimeoutError("no connection was free")])

    @app.get("/away")
    def away() -> str:
        raise next(errors)

    for _ in range(2):
        answer = app.test_client().get("/away")
        assert answer.status_code == 503
        assert "What you answered before is stored" in answer.text
    assert not re.search("secret|Traceback", caplog.text)


def test_four_windows_may_report_for_an_hour_and_a_flood_delays_only_itself() -> None:
    pace = Pace()
    every_two_seconds_and_at_each_end = 0.5 + 0.2
    reports = int(3600 * 4 * every_two_seconds_and_at_each_end)
    assert {pace.seconds_to_wait("four", 3600 * n / reports) for n in range(reports)} == {0.0}

    for _ in range(AT_ONCE):
        pace.seconds_to_wait("one", 3600.0)
    others = {pace.seconds_to_wait(f"{number}", 3600.0) for number in range(KEPT + 10)}

    assert others == {0.0}
    assert pace.seconds_to_wait("one", 3600.0) > 0


def test_oversized_requests_are_refused_unread_and_block_nobody(
    app: Flask, clock: SetClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    flooding, other = (Visitor(app, clock).enrol().begin() for _ in range(2))
    address = flooding.page().value("#pair", "data-watched-url")
    monkeypatch.setattr("studyapp.web.app.time.monotonic", lambda: 7.0)
    for _ in range(AT_ONCE):
        assert flooding.client.post(address, json=WATCHED).status_code != 429
    with monkeypatch.context() as patch:
        patch.delattr(participant, "record_watched")
        refused = flooding.client.post(address, data=b"\xff")

    assert (refused.status_code, refused.headers["Retry-After"]) == (429, "1")
    other.watch()
    assert flooding.client.get(flooding.address).status_code == 200
    monkeypatch.setattr("studyapp.web.app.time.monotonic", lambda: 8.0)
    flooding.watch()


@contextmanager
def full_disk() -> Iterator[None]:
    """Let no file grow, nor be written beyond its first bytes."""
    assert signal.getsignal(signal.SIGXFSZ) is signal.SIG_IGN
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_health_fails_if_the_database_cannot_be_written(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = app.test_client()
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    with full_disk():
        full = client.get("/healthz")
    with monkeypatch.context() as patch:
        # A small write still fits into the log of the database.
        patch.setattr("studyapp.database.engine.disk_usage", lambda _: SimpleNamespace(free=4096))
        assert client.get("/healthz").status_code == 503
    well = client.get("/healthz")
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 60.0)
    with full_disk():
        asked_again_soon = client.get("/healthz")

    assert (full.status_code, full.text) == (503, "Answers cannot be stored.\n")
    assert (well.status_code, well.text, asked_again_soon.status_code) == (200, "ok\n", 200)
    assert well.headers["Cache-Control"] == "no-store"
    assert "Set-Cookie" not in well.headers


def test_health_answers_even_if_the_database_does_not(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    thawed, databases = threading.Event(), list[Database]()

    def wait_for_it(database: Database) -> None:
        databases.append(database)
        thawed.wait(60)

    monkeypatch.setattr(Database, "check_writable", wait_for_it)
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 0.05)
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    client = app.test_client()

    frozen = [client.get("/healthz").status_code for _ in range(3)]
    asked_while_frozen = len(databases)
    thawed.set()
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 60.0)

    assert (frozen, asked_while_frozen) == ([503] * 3, 1)
    assert client.get("/healthz").status_code == 200
