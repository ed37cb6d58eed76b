"""What every request needs: the study, its database and clock, and the client's address."""

import hashlib
import ipaddress
import os
from abc import ABC, abstractmethod
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import ClassVar, Final, Literal, cast

from flask import Flask, Response, current_app, request

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.researchers.interim_figures import FigureProcess
from studyapp.session.served_study import ServedStudy, VideoRecord
from studyapp.study.settings.study import Study
from studyapp.web.media_store import MediaStore

EXTENSION: Final = "motionjury"


@dataclass(frozen=True, kw_only=True)
class Desk:
    """The desk that serves a study.

    Attributes
    ----------
    database : Database
        Where its accounts are.
    address : str
        The study's page there, from the host's root.
    """

    database: Database
    address: str


@dataclass(frozen=True, kw_only=True)
class Site(ABC):
    """Where researchers log in: a study, or the desk of several.

    Attributes
    ----------
    database : Database
        Where the accounts are.
    origin : str
        What the public addresses begin with, before the path; empty if unknown.
    desk : Desk or None
        The desk at which researchers log in; None if they log in here.
    """

    kind: ClassVar[Literal["study", "desk"]]
    database: Database
    clock: Clock
    origin: str = ""
    desk: Desk | None = None

    @property
    @abstractmethod
    def name(self) -> str:
        """Its name among others on the host."""

    @property
    @abstractmethod
    def title(self) -> str:
        """The title of its pages."""


@dataclass(frozen=True, kw_only=True)
class StudySite(Site):
    """The study being served; see `Site` for what it shares with a desk.

    Attributes
    ----------
    folder : Path
        The study folder.
    record : VideoRecord
        Checks that its videos are still those that are served.
    figures : FigureProcess
        Computes the interim figures of researchers' pages.
    accel_prefix : str or None
        Where a proxy in front finds that folder; None if this server sends the videos itself.
    store : MediaStore or None
        Where participants load the videos from instead.
    """

    kind = "study"
    served: ServedStudy
    folder: Path
    record: VideoRecord
    figures: FigureProcess
    accel_prefix: str | None = None
    store: MediaStore | None = None

    @property
    def name(self) -> str:
        """The study's name."""
        return self.study.name

    @property
    def title(self) -> str:
        """What participants see as the study's title."""
        return self.study.title

    @property
    def study(self) -> Study:
        """The study's definition."""
        return self.served.study


def attach(app: Flask, site: Site) -> None:
    """Make `site` known to the requests of `app`."""
    app.extensions[EXTENSION] = site


def current_site() -> Site:
    """Return where the researcher of the present request logs in."""
    return cast(Site, current_app.extensions[EXTENSION])


def site_of(app: Flask) -> StudySite:
    """Return what `app` serves, which is one study."""
    return cast(StudySite, app.extensions[EXTENSION])


def study_site() -> StudySite:
    """Return the study that the present request is for, with all that answering needs."""
    return site_of(current_app)


PROXIES: Final = "FORWARDED_ALLOW_IPS"
"""Names the trusted proxies; gunicorn reads it too."""

OWN_NETWORK: Final = 64
"""Leading bits of an IPv6 address that a household or an institute shares."""


def client_address() -> str:
    """Return the client's address; of IPv6, its network, as every client has many addresses.

    A proxy names its client in the last entry of ``X-Forwarded-For``. It is trusted if the
    environment names it in ``FORWARDED_ALLOW_IPS``.
    """
    peer = _parsed(request.remote_addr or "")
    forwarded = _parsed(request.headers.get("X-Forwarded-For", "").rpartition(",")[2].strip())
    client = forwarded if forwarded is not None and _is_trusted(peer) else peer
    if client is None:
        return "unknown"
    if isinstance(client, ipaddress.IPv6Address):
        if client.ipv4_mapped is not None:
            return str(client.ipv4_mapped)
        return str(ipaddress.ip_network((client, OWN_NETWORK), strict=False))
    return str(client)


def newcomers_address() -> str | None:
    """Return `client_address`, None behind a proxy that is not trusted.

    All participants would share the address of such a proxy.
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
    """Return whether the peer is a trusted proxy; without an address, it is a local socket."""
    networks = believed_proxies()
    return peer is None or networks is None or any(peer in network for network in networks)


def believed_proxies() -> tuple[Network, ...] | None:
    """Return the networks of trusted proxies; None for all.

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


@dataclass(frozen=True)
class TokenCookie:
    """A cookie with a token that identifies a visitor.

    Attributes
    ----------
    whose : str
        What its name begins with.
    path : str
        The pages that get it, from the study's root.
    lifetime : timedelta or None
        How long the browser keeps it; None until it is closed.
    """

    whose: str
    path: str
    lifetime: timedelta | None = None

    def name(self, study: str) -> str:
        """Return its name, which differs between studies on one host."""
        return f"{self.whose}-{hashlib.sha256(study.encode()).hexdigest()[:8]}"

    def read(self, study: str) -> str | None:
        """Return the token that the browser sent, None if it sent none."""
        return request.cookies.get(self.name(study))

    def send(self, response: Response, study: str, token: str, *, below: str = "") -> None:
        """Have the browser keep `token`, for the pages of a study at the path `below`."""
        response.set_cookie(
            self.name(study),
            token,
            max_age=self.lifetime,
            path=request.script_root + below + self.path,
            secure=request.is_secure,
            httponly=True,
            samesite="Lax",
        )
