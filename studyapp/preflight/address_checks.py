"""Whether the study can be reached where participants will look for it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final
from urllib.parse import urlsplit

import httpx

from studyapp.preflight.finding import Finding, finding

SECONDS: Final = 15.0
HEALTH: Final = "healthz"
SCRIPT: Final = "static/players.js"
"""A file that is sent in pieces as videos are; a video has no address before somebody begins."""

_LOCAL: Final = frozenset({"localhost", "127.0.0.1", "::1"})


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
        yield finding("address-insecure", f"{base} does not begin with https://", where=base)
    try:
        with httpx.Client(
            base_url=base, timeout=SECONDS, follow_redirects=True, transport=transport
        ) as client:
            health = client.get(HEALTH)
            if health.status_code != 200 or health.text.strip() != "ok":
                yield finding(
                    "address-other",
                    f"{base}{HEALTH} answers {health.status_code}, not as a study's server that is "
                    "well",
                    where=base,
                )
                return
            piece = client.get(
                SCRIPT, headers={"Range": "bytes=0-9", "Accept-Encoding": "identity"}
            )
            if piece.status_code != 206 or len(piece.content) != 10:
                yield finding(
                    "ranges-lost",
                    f"asked for 10 bytes of {base}{SCRIPT}, it answers {piece.status_code} with "
                    f"{len(piece.content)}",
                    where=base,
                )
    except (httpx.HTTPError, httpx.InvalidURL) as lost:
        yield finding(
            "address-unreachable",
            f"{base} cannot be reached: {lost or type(lost).__name__}",
            where=base,
        )
