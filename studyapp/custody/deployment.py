"""The validated names, addresses and paths in the files of a server."""

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
"""The folder of studies on a server."""

INSTALLED: Final = PurePosixPath("/opt/motionjury")
"""The installation of Motion Jury on a server."""

PORT: Final = 8000

LABEL: Final = r"[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?"
HOST: Final = re.compile(rf"({LABEL}\.)*{LABEL}")
MAX_HOST_LENGTH: Final = 253
NAME: Final = re.compile(r"[a-z0-9]([a-z0-9-]{0,30}[a-z0-9])?")
MAIL: Final = re.compile(r"[A-Za-z0-9._+-]{1,64}@(.+)")
UNSAFE: Final = re.compile(r"""[\x00-\x1f\x7f"'`$\\]""")
"""Characters that a folder's name must not contain, since not every file can quote them."""


@dataclass(frozen=True, kw_only=True)
class Deployment:
    """One study on one server.

    Attributes
    ----------
    name : str
        Names the study's service, files and database on the server.
    title : str
        The study's title in one line.
    folder : PurePosixPath
        The study folder on the server.
    host : str
        The server's name on the internet.
    prefix : str
        Path under which the study is served; empty if it has its own host.
    proxy, database : str
        What the study's server runs behind, and where it stores answers.
    contact : str
        E-mail address for the certificate authority; may be empty.
    port : int
        Port of the study's server, used only by the proxy; each study needs its own.
    installed : PurePosixPath
        Motion Jury's virtual environment on the server.
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
        """The public address of the study."""
        return f"https://{self.host}{self.prefix}/"

    @property
    def unit(self) -> str:
        """The study's unit in systemd."""
        return f"motionjury-{self.name}"

    @property
    def database_name(self) -> str:
        """The study's database in PostgreSQL."""
        return f"motionjury_{self.name.replace('-', '_')}"

    @property
    def inner_location(self) -> str:
        """The study folder's internal location in nginx, which cannot be requested from outside."""
        return f"/study-files/{self.name}"


def plan_deployment(
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
        If the host, the prefix or the contact is invalid, or no service can be named after the
        folder.
    """
    path = PurePosixPath(folder)
    return Deployment(
        name=_service_name(path),
        title=_one_line(title),
        folder=path,
        host=_check_host(host),
        prefix=checked_prefix(prefix),
        proxy=proxy,
        database=database,
        contact=_check_mail(contact),
        port=port,
    )


def _service_name(folder: PurePosixPath) -> str:
    if not folder.is_absolute() or ".." in folder.parts or UNSAFE.search(str(folder)):
        raise InputError(
            "a service cannot use this folder",
            where=f"folder {str(folder)!r}",
            remedy="Give the absolute path on the server, without quotes, $ and \\",
        )
    name = folder.name.lower().replace("_", "-").replace(" ", "-")
    if NAME.fullmatch(name) is None:
        raise InputError(
            "no service or database can be named after this folder",
            where=f"folder {str(folder)!r}",
            remedy="On the server, use a name of up to 32 letters a to z, digits and '-', such as "
            f"{STUDIES}/gestures-2",
        )
    return name


def _one_line(title: str) -> str:
    """Return `title` in a form that systemd can show within quotes."""
    words = " ".join(title.split())
    return "".join(c for c in words if c.isprintable()).replace('"', "'").replace("\\", "/")


def _check_host(text: str) -> str:
    host = text.lower()
    is_number = host.rpartition(".")[2].isdigit()
    if HOST.fullmatch(host) is None or len(host) > MAX_HOST_LENGTH or is_number:
        raise InputError(
            "this is not a host name",
            where=f"host {text!r}",
            remedy="Give only the name, such as study.example.org, without https://, port and "
            "path; write letters other than a to z in the form xn--…",
        )
    return host


def _check_mail(text: str) -> str:
    match = MAIL.fullmatch(text)
    if text and (match is None or HOST.fullmatch(match[1].lower()) is None):
        raise InputError(
            "this is not an e-mail address",
            where=f"contact {text!r}",
            remedy="Give one such as ada@example.org",
        )
    return text
