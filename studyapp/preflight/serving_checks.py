"""Whether the study can be served: its database, disk and videos here, and its address."""

from __future__ import annotations

import os
import secrets
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

import httpx
from flask import Flask
from sqlalchemy import select

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.database.tables import Video
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.preflight.time_checks import arrivals
from studyapp.recruitment.record import places_of
from studyapp.session.arrivals import Arrival
from studyapp.session.comprehension import begin
from studyapp.session.enrolment import enrol
from studyapp.session.intake import present_intake
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import must_be_new_version
from studyapp.stimuli.disk_space import as_text
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.questions import Form
from studyapp.study.settings.study import Study
from studyapp.study.versioning import design_digest
from studyapp.web.app import create_app
from studyapp.web.running import running

SECONDS: Final = 15.0
HEALTH: Final = "healthz"
SCRIPT: Final = "static/players.js"
"""A file that is sent in pieces as videos are; a video has no address before somebody begins."""

_LOCAL: Final = frozenset({"localhost", "127.0.0.1", "::1"})


def for_probing(served: ServedStudy) -> ServedStudy:
    """Return the study with nothing before its first trial, open to whoever comes."""
    study = served.study
    page = study.page.model_copy(update={"sound_check": False})
    return replace(
        served, study=study.model_copy(update={"open": True, "form": Form(), "page": page})
    )


def token_of_a_video(database: Database, served: ServedStudy, clock: Clock) -> str:
    """Let somebody begin, and name the first video that they are shown.

    Parameters
    ----------
    served : ServedStudy
        From `for_probing`.
    """
    token = enrol(database, served, Arrival(visit=secrets.token_urlsafe()), clock)
    asked = served.study.form.comprehension
    answers = {question.name: question.example for question in asked}
    begin(database, served, token, clock, answers=answers)
    with database.reading() as session:
        return session.scalars(select(Video.token).order_by(Video.id).limit(1)).one()


BYTES_PER_PARTICIPANT: Final = 200_000
"""What a study session may leave in the database. Simulated participants leave 27 kB (30 pairs) to
39 kB (rankings); people pause and replay, which leaves more evidence of watching."""

SPARE: Final = 10**9
"""Bytes that should stay free: a full disk loses answers of all that runs on it."""

_PIECE: Final = 100
_RANGE: Final = f"bytes=0-{_PIECE - 1}"


def serving_findings(material: Material) -> Iterator[Finding]:
    """Say whether answers can be stored, and where."""
    yield from _database_findings(material)
    yield from _room_findings(material.folder, material.study)
    if not material.folder.rehearsal.exists():
        yield finding("not-rehearsed")


def _database_findings(material: Material) -> Iterator[Finding]:
    url = database_url_of(material.folder.root)
    try:
        database = Database.open_for_reading(url, of_any_age=True)
    except InputError as unusable:
        yield finding(
            "database-unusable", unusable.what, where=unusable.where, remedy=unusable.remedy or None
        )
        return
    if database is None:
        return
    try:
        current = Database.open_for_reading(url)
    except InputError as older:
        database.close()
        yield finding("database-older", older.what, where=older.where)
        return
    database.close()
    if current is None:
        return
    try:
        count = arrivals(current)
        if count:
            yield finding("answers-there", count=count)
        with current.reading() as session:
            state = present_intake(session).state
        if state != "open":
            yield finding("intake-closed", state=state)
        design = design_digest(material.study, material.segments, material.shown)
        # A study that lacks videos is told so elsewhere; its design is not known yet.
        if set(material.contents) <= material.shown.keys() and must_be_new_version(current, design):
            yield finding("design-changed")
    finally:
        current.close()


def _room_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    """Say whether the folder can be written, and has room for the answers of all places."""
    if database_url_of(folder.root) != sqlite_url(folder.responses):
        return
    if not os.access(folder.root, os.W_OK):
        yield finding("folder-unwritable", where=str(folder.root))
        return
    needed = places_of(study) * BYTES_PER_PARTICIPANT
    free = shutil.disk_usage(folder.root).free
    if free < needed + SPARE:
        yield finding(
            "disk-full" if free < needed else "disk-short",
            free=as_text(free),
            participants=places_of(study),
            needed=as_text(needed),
        )


def probe_findings(material: Material) -> Iterator[Finding]:
    """Serve the study to one participant on a database that is thrown away, and ask for a video.

    For studies without errors: a server does not start for others.
    """
    root = material.folder.root
    try:
        served = for_probing(ServedStudy.read(root))
        with tempfile.TemporaryDirectory() as scratch:
            app = create_app(
                root,
                database_url=sqlite_url(Path(scratch) / "probe.db"),
                rehearsal_speed=1.0,
                served=served,
            )
            yield from _range_findings(app, served)
    except InputError as refused:
        yield finding(
            "cannot-be-served", refused.what, where=refused.where, remedy=refused.remedy or None
        )


def _range_findings(app: Flask, served: ServedStudy) -> Iterator[Finding]:
    with app.app_context():
        here = running()
    try:
        token = token_of_a_video(here.database, served, Clock())
        response = app.test_client().get(f"/media/{token}.mp4", headers={"Range": _RANGE})
        with response:
            status, got = response.status_code, len(response.data)
            elsewhere = response.location if 300 <= status < 400 else None
        asked = "the study's server"
        if elsewhere is not None:
            asked = "the store that videos come from"
            status, got = _from_store(elsewhere)
        if status != 206 or got != _PIECE:
            yield finding(
                "no-byte-ranges",
                f"asked for {_PIECE} bytes of a video, {asked} answered {status} with {got}",
            )
    except httpx.HTTPError as lost:
        yield finding(
            "no-byte-ranges", f"the store that videos come from cannot be reached: {lost}"
        )
    finally:
        here.database.close()


def _from_store(address: str) -> tuple[int, int]:
    """Ask a store of videos for a piece; return its status, and how many bytes came."""
    with httpx.stream("GET", address, headers={"Range": _RANGE}, timeout=SECONDS) as answer:
        # A store that knows no ranges would send all of it.
        got = sum(len(piece) for piece, _ in zip(answer.iter_bytes(_PIECE), range(2), strict=False))
        return answer.status_code, got


def address_findings(
    address: str, *, transport: httpx.BaseTransport | None = None
) -> Iterator[Finding]:
    """Ask for the study at `address`.

    Parameters
    ----------
    address : str
        Where participants will come to, such as ``https://study.example.org/``.
    transport : httpx.BaseTransport, optional
        How requests travel, if not over the network.
    """
    base = address if address.endswith("/") else f"{address}/"
    parts = urlsplit(base)
    if parts.scheme != "https" and parts.hostname not in _LOCAL:
        yield finding("address-insecure", where=base)
    try:
        with httpx.Client(
            base_url=base, timeout=SECONDS, follow_redirects=True, transport=transport
        ) as client:
            health = client.get(HEALTH)
            if health.status_code != 200 or health.text.strip() != "ok":
                yield finding("address-other", where=base, page=HEALTH, status=health.status_code)
                return
            piece = client.get(
                SCRIPT, headers={"Range": "bytes=0-9", "Accept-Encoding": "identity"}
            )
            if piece.status_code != 206 or len(piece.content) != 10:
                yield finding(
                    "ranges-lost",
                    where=base,
                    file=SCRIPT,
                    status=piece.status_code,
                    got=len(piece.content),
                )
    except (httpx.HTTPError, httpx.InvalidURL) as lost:
        yield finding("address-unreachable", where=base, why=str(lost) or type(lost).__name__)
