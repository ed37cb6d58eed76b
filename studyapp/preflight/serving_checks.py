"""Whether the study can be served: its database, its disk and its address."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import closing
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from sqlalchemy import func, select

from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.database.tables.study_session import StudySession
from studyapp.preflight.finding import Finding, finding_of_error, make_finding
from studyapp.preflight.material import Material
from studyapp.recruitment.record import count_places
from studyapp.session.intake import current_intake
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import needs_new_version
from studyapp.study.folder import StudyFolder, format_size
from studyapp.study.settings.study import Study
from studyapp.study.versioning import design_digest

if TYPE_CHECKING:
    import httpx

TIMEOUT_SECONDS: Final = 15.0
HEALTH: Final = "healthz"
SCRIPT: Final = "static/players.js"
"""Sent in byte ranges as videos are; videos have no address before a participant arrives."""

_LOCAL: Final = frozenset({"localhost", "127.0.0.1", "::1"})

BYTES_PER_PARTICIPANT: Final = 200_000
"""A generous bound. Simulated participants leave 27 kB (30 pairs) to 39 kB (rankings); people pause
and replay, which leaves more evidence of watching."""

SPARE_BYTES: Final = 10**9
"""Should stay free: a full disk loses the answers of every study on it."""


def serving_findings(material: Material) -> Iterator[Finding]:
    """Yield what keeps answers from being stored, and whether the study was rehearsed."""
    yield from _database_findings(material)
    yield from _disk_findings(material.folder, material.study)
    if not material.folder.rehearsal.exists():
        yield make_finding("not-rehearsed")


def _database_findings(material: Material) -> Iterator[Finding]:
    url = database_url_of(material.folder.root)
    try:
        database = Database.open_for_reading(url, of_any_age=True)
    except InputError as error:
        yield finding_of_error("database-unusable", error)
        return
    if database is None:
        return
    try:
        current = Database.open_for_reading(url)
    except InputError as error:
        database.close()
        yield make_finding("database-older", error.what, where=error.where)
        return
    database.close()
    if current is None:
        return
    with closing(current):
        with current.reading() as session:
            count = session.scalar(select(func.count(StudySession.id)))
            state = current_intake(session).state
        if count:
            yield make_finding("answers-there", count=count)
        if state != "open":
            yield make_finding("intake-closed", state=state)
        design = design_digest(material.study, material.segments, material.shown)
        # Without all videos the design is not known yet.
        if set(material.contents) <= material.shown.keys() and needs_new_version(current, design):
            yield make_finding("design-changed")


def _disk_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    """Yield a folder that is not writable, or too full for the answers of all places."""
    if database_url_of(folder.root) != sqlite_url(folder.responses):
        return
    if not os.access(folder.root, os.W_OK):
        yield make_finding("folder-unwritable", where=str(folder.root))
        return
    needed = count_places(study) * BYTES_PER_PARTICIPANT
    free = shutil.disk_usage(folder.root).free
    if free < needed + SPARE_BYTES:
        yield make_finding(
            "disk-full" if free < needed else "disk-short",
            free=format_size(free),
            participants=count_places(study),
            needed=format_size(needed),
        )


def server_findings(material: Material) -> Iterator[Finding]:
    """Read the study as its server does before it starts."""
    try:
        ServedStudy.read(material.folder.root)
    except InputError as error:
        yield finding_of_error("cannot-be-served", error)


def address_findings(
    address: str, *, transport: httpx.BaseTransport | None = None
) -> Iterator[Finding]:
    """Request the study at `address`.

    Parameters
    ----------
    address : str
        The address that participants will use, such as ``https://study.example.org/``.
    transport : httpx.BaseTransport, optional
        Replaces the network.
    """
    # Imported here: most checks send no request.
    import httpx

    base = address if address.endswith("/") else f"{address}/"
    parts = urlsplit(base)
    if parts.scheme != "https" and parts.hostname not in _LOCAL:
        yield make_finding("address-insecure", where=base)
    try:
        with httpx.Client(
            base_url=base, timeout=TIMEOUT_SECONDS, follow_redirects=True, transport=transport
        ) as client:
            health = client.get(HEALTH)
            if health.status_code != 200 or health.text.strip() != "ok":
                yield make_finding(
                    "address-other", where=base, page=HEALTH, status=health.status_code
                )
                return
            partial = client.get(
                SCRIPT, headers={"Range": "bytes=0-9", "Accept-Encoding": "identity"}
            )
            if partial.status_code != 206 or len(partial.content) != 10:
                yield make_finding(
                    "ranges-lost",
                    where=base,
                    file=SCRIPT,
                    status=partial.status_code,
                    received=len(partial.content),
                )
    except (httpx.HTTPError, httpx.InvalidURL) as error:
        yield make_finding(
            "address-unreachable", where=base, why=str(error) or type(error).__name__
        )
