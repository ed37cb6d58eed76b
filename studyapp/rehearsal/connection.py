"""How simulated participants reach the study's server."""

from __future__ import annotations

import ssl
from typing import Final

import httpx

REQUEST_SECONDS: Final = 60.0


def study_client(server: str) -> httpx.Client:
    """Return a client for one participant of the server at address `server`.

    Every request opens a connection of its own. A server closes those that nobody has used for
    some seconds, as long as a participant may watch; a request on its way at that very moment
    would be lost, and only browsers send it again by themselves.
    """
    return httpx.Client(
        base_url=server,
        follow_redirects=True,
        timeout=REQUEST_SECONDS,
        limits=httpx.Limits(max_keepalive_connections=0),
        trust_env=False,
        # Certificates are not needed on the loopback, and loading them takes longer than a visit.
        verify=ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT),
        headers={"Accept": "text/html"},
    )
