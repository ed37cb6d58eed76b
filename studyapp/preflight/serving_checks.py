"""Whether the study can be served: its database, disk and videos here, and its address."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from typing import Final
from urllib.parse import urlsplit

import httpx

from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.preflight.time_checks import arrivals
from studyapp.recruitment.record import places_of
from studyapp.session.intake import present_intake
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import must_be_new_version
from studyapp.stimuli.disk_space import as_text
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.versioning import design_digest

SECONDS: Final = 15.0
HEALTH: Final = "healthz"
SCRIPT: Final = "static/players.js"
"""A file that is sent in pieces as videos are; a video has no address before somebody begins."""

_LOCAL: Final = frozenset({"localhost", "127.0.0.1", "::1"})

BYTES_PER_PARTICIPANT: Final = 200_000
"""What a study session may leave in the database. Simulated participants leave 27 kB (30 pairs) to
39 kB (rankings); people pause and replay, which leaves more evidence of watching."""

SPARE: Final = 10**9
"""Bytes that should stay free: a full disk loses answers of all that runs on it."""


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


def read_findings(material: Material) -> Iterator[Finding]:
    """Read a study without errors as its server does before it starts."""
    try:
        ServedStudy.read(material.folder.root)
    except InputError as refused:
        yield finding(
            "cannot-be-served", refused.what, where=refused.where, remedy=refused.remedy or None
        )


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
