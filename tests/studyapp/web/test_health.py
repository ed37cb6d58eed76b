"""What is told to whatever watches the server."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from flask import Flask
from sqlalchemy import create_engine

from studyapp.services.database import Database
from studyapp.web.running import attach, running


def test_a_server_that_is_well_says_so_and_nothing_else(app: Flask) -> None:
    answer = app.test_client().get("/healthz")

    assert (answer.status_code, answer.text) == (200, "ok\n")
    assert answer.headers["Cache-Control"] == "no-store"
    assert "Set-Cookie" not in answer.headers


def test_without_its_database_it_is_not_well(app: Flask, tmp_path: Path) -> None:
    away = Database(create_engine(f"sqlite:///{tmp_path / 'nowhere' / 'responses.db'}"))
    with app.app_context():
        attach(app, replace(running(), database=away))

    answer = app.test_client().get("/healthz")

    assert (answer.status_code, answer.text) == (503, "The database is away.\n")
