"""What is told to whatever watches the server."""

from __future__ import annotations

import resource
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import create_engine

from studyapp.database.engine import Database
from studyapp.web.running import attach, running


def test_a_server_that_is_well_says_so_and_nothing_else(app: Flask) -> None:
    answer = app.test_client().get("/healthz")

    assert (answer.status_code, answer.text) == (200, "ok\n")
    assert answer.headers["Cache-Control"] == "no-store"
    assert "Set-Cookie" not in answer.headers


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
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    client = app.test_client()
    assert client.get("/healthz").status_code == 200

    with full_disk():
        full = client.get("/healthz")
    again = client.get("/healthz")

    assert (full.status_code, again.status_code) == (503, 200)


def test_asking_often_writes_once(app: Flask, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Database] = []
    monkeypatch.setattr(Database, "try_writing", lambda database: asked.append(database))

    answers = [app.test_client().get("/healthz").status_code for _ in range(5)]

    assert (answers, len(asked)) == ([200] * 5, 1)


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


def test_without_its_database_it_is_not_well(app: Flask, tmp_path: Path) -> None:
    away = Database(create_engine(f"sqlite:///{tmp_path / 'nowhere' / 'responses.db'}"))
    with app.app_context():
        attach(app, replace(running(), database=away))

    answer = app.test_client().get("/healthz")

    assert (answer.status_code, answer.text) == (503, "Answers cannot be stored.\n")
