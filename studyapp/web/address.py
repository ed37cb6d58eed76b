"""From which network address a request came, behind a proxy too."""

from __future__ import annotations

import ipaddress
import os
from typing import Final

from flask import request

from motion.errors import InputError

PROXIES: Final = "FORWARDED_ALLOW_IPS"
"""Names the proxies that are believed; gunicorn reads it too."""

OWN_NETWORK: Final = 64
"""Leading bits of an IPv6 address that are one household's or institute's."""


def client_address() -> str:
    """Return the address that asks; of IPv6, its network, as anybody has very many addresses.

    A proxy says for whom it asks, in the last entry of ``X-Forwarded-For``. It is believed where
    the environment names it in ``FORWARDED_ALLOW_IPS``, as the server itself does.
    """
    peer = _parsed(request.remote_addr or "")
    forwarded = _parsed(request.headers.get("X-Forwarded-For", "").rpartition(",")[2].strip())
    found = forwarded if forwarded is not None and _is_trusted(peer) else peer
    if found is None:
        return "unknown"
    if isinstance(found, ipaddress.IPv6Address):
        if found.ipv4_mapped is not None:
            return str(found.ipv4_mapped)
        return str(ipaddress.ip_network((found, OWN_NETWORK), strict=False))
    return str(found)


def newcomers_address() -> str | None:
    """Return `client_address`, None where a proxy asks that is not believed.

    The address of such a proxy would be that of everybody.
    """
    peer = _parsed(request.remote_addr or "")
    proxied = "X-Forwarded-For" in request.headers and (peer is None or not peer.is_global)
    return None if proxied and not _is_trusted(peer) else client_address()


Address = ipaddress.IPv4Address | ipaddress.IPv6Address
Network = ipaddress.IPv4Network | ipaddress.IPv6Network


def _parsed(text: str) -> Address | None:
    try:
        return ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        return None


def _is_trusted(peer: Address | None) -> bool:
    """Tell whether the one that asks is a proxy of ours; without an address it is a socket."""
    networks = believed_proxies()
    return peer is None or networks is None or any(peer in network for network in networks)


def believed_proxies() -> tuple[Network, ...] | None:
    """Return the networks whose proxies are believed; None for all.

    Raises
    ------
    InputError
        If the environment names something that is not a network.
    """
    named = os.environ.get(PROXIES, "127.0.0.1,::1").split(",")
    if "*" in named:
        return None
    try:
        return tuple(ipaddress.ip_network(text.strip()) for text in named if text.strip())
    except ValueError as error:
        raise InputError(
            f"the environment variable names no network address: {error}",
            where=PROXIES,
            remedy="Name the proxies by address, such as 10.0.0.5,10.1.0.0/16",
        ) from error
