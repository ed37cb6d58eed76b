"""What is told to whatever watches the server."""

from __future__ import annotations

import resource
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from flask import Flask

from studyapp.database.engine import Database


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


def test_where_nothing_can_be_written_it_is_not_well(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = app.test_client()
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    with full_disk():
        full = client.get("/healthz")
    well = client.get("/healthz")
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 60.0)
    with full_disk():
        asked_again_soon = client.get("/healthz")

    assert (full.status_code, full.text) == (503, "Answers cannot be stored.\n")
    assert (well.status_code, well.text, asked_again_soon.status_code) == (200, "ok\n", 200)
    assert well.headers["Cache-Control"] == "no-store"
    assert "Set-Cookie" not in well.headers


def test_where_the_database_does_not_answer_it_is_not_well_and_says_so_all_the_same(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    thawed, asked = threading.Event(), list[Database]()

    def wait_for_it(database: Database) -> None:
        asked.append(database)
        thawed.wait(60)

    monkeypatch.setattr(Database, "try_writing", wait_for_it)
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 0.05)
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    client = app.test_client()

    frozen = [client.get("/healthz").status_code for _ in range(3)]
    asked_while_frozen = len(asked)
    thawed.set()
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 60.0)

    assert (frozen, asked_while_frozen) == ([503] * 3, 1)
    assert client.get("/healthz").status_code == 200
