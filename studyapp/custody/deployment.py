"""What a server's files are made of: names, addresses and paths, all of them checked."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final, Literal

from motion.errors import InputError
from studyapp.web.mounting import checked_prefix

Proxy = Literal["caddy", "nginx"]
DatabaseKind = Literal["sqlite", "postgresql"]

PROXIES: Final[tuple[Proxy, ...]] = ("caddy", "nginx")
DATABASES: Final[tuple[DatabaseKind, ...]] = ("sqlite", "postgresql")

STUDIES: Final = PurePosixPath("/srv/motionjury")
"""Where studies lie on a server."""

INSTALLED: Final = PurePosixPath("/opt/motionjury")
"""Where Motion Jury is installed on a server."""

PORT: Final = 8000

LABEL: Final = r"[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?"
HOST: Final = re.compile(rf"({LABEL}\.)*{LABEL}")
LONGEST_HOST: Final = 253
NAME: Final = re.compile(r"[a-z0-9]([a-z0-9-]{0,30}[a-z0-9])?")
MAIL: Final = re.compile(r"[A-Za-z0-9._+-]{1,64}@(.+)")
UNSAFE: Final = re.compile(r"""[\x00-\x1f\x7f"'`$\\]""")
"""What no folder on a server may have in its name: not every file could hold it."""


@dataclass(frozen=True, kw_only=True)
class Deployment:
    """One study on one server.

    Attributes
    ----------
    name : str
        By which the study's service, files and database are known there.
    title : str
        What the study is called to people, in one line.
    folder : PurePosixPath
        The study folder on the server.
    host : str
        The server's name on the internet.
    prefix : str
        Path below which the study is served; empty where it has the host to itself.
    proxy, database
        What stands before and behind the study's server.
    contact : str
        Mail address that the certificates' issuer may write to; empty for none.
    port : int
        Where the study's server listens, for the proxy alone; each study has its own.
    installed : PurePosixPath
        Motion Jury's virtual environment there.
    """

    name: str
    title: str
    folder: PurePosixPath
    host: str
    prefix: str = ""
    proxy: Proxy = "caddy"
    database: DatabaseKind = "sqlite"
    contact: str = ""
    port: int = PORT
    installed: PurePosixPath = INSTALLED

    @property
    def address(self) -> str:
        """Where participants find the study."""
        return f"https://{self.host}{self.prefix}/"

    @property
    def unit(self) -> str:
        """What systemd knows the study's server by."""
        return f"motionjury-{self.name}"

    @property
    def database_name(self) -> str:
        """The study's database in PostgreSQL."""
        return f"motionjury_{self.name.replace('-', '_')}"

    @property
    def inner_location(self) -> str:
        """What nginx knows the study folder by; nobody can ask for it from outside."""
        return f"/study-files/{self.name}"


def planned_deployment(
    *,
    title: str,
    folder: Path | PurePosixPath,
    host: str,
    prefix: str = "",
    proxy: Proxy = "caddy",
    database: DatabaseKind = "sqlite",
    contact: str = "",
    port: int = PORT,
) -> Deployment:
    """Return the deployment of a study whose folder on the server is `folder`.

    Raises
    ------
    InputError
        If a value cannot stand in the files: a host that is none, a folder with a name that no
        service can have, a path or a mail address that is none.
    """
    place = PurePosixPath(folder)
    return Deployment(
        name=_name_of(place),
        title=_one_line(title),
        folder=place,
        host=_checked_host(host),
        prefix=checked_prefix(prefix),
        proxy=proxy,
        database=database,
        contact=_checked_mail(contact),
        port=port,
    )


def _name_of(folder: PurePosixPath) -> str:
    if not folder.is_absolute() or ".." in folder.parts or UNSAFE.search(str(folder)):
        raise InputError(
            "this is not a folder that a service could be given",
            where=f"folder {str(folder)!r}",
            remedy="Name the whole path on the server, without quotes, $ and \\",
        )
    name = folder.name.lower().replace("_", "-").replace(" ", "-")
    if NAME.fullmatch(name) is None:
        raise InputError(
            "no service and no database could be named after this folder",
            where=f"folder {str(folder)!r}",
            remedy="Call it on the server by at most 32 letters a to z, digits and '-', such as "
            f"{STUDIES}/gestures-2",
        )
    return name


def _one_line(title: str) -> str:
    """Return `title` as systemd can show it within quotes."""
    words = " ".join(title.split())
    return "".join(c for c in words if c.isprintable()).replace('"', "'").replace("\\", "/")


def _checked_host(text: str) -> str:
    host = text.lower()
    is_number = host.rpartition(".")[2].isdigit()
    if HOST.fullmatch(host) is None or len(host) > LONGEST_HOST or is_number:
        raise InputError(
            "this is not a name of a host",
            where=f"host {text!r}",
            remedy="Give the name alone, such as study.example.org, without https://, port and "
            "path; letters other than a to z in the form xn--…",
        )
    return host


def _checked_mail(text: str) -> str:
    found = MAIL.fullmatch(text)
    if text and (found is None or HOST.fullmatch(found[1].lower()) is None):
        raise InputError(
            "this is not a mail address",
            where=f"contact {text!r}",
            remedy="Give one such as ada@example.org",
        )
    return text
