"""The files that a public server needs to serve a study or a desk."""

import os
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Annotated, Final, Literal

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from pydantic import AfterValidator, BaseModel, ConfigDict

from motion.errors import InputError
from studyapp.web.mounting import checked_prefix

Proxy = Literal["caddy", "nginx"]
DatabaseKind = Literal["sqlite", "postgresql"]

PROXIES: Final[tuple[Proxy, ...]] = ("caddy", "nginx")
DATABASES: Final[tuple[DatabaseKind, ...]] = ("sqlite", "postgresql")

STUDIES: Final = PurePosixPath("/srv/motionjury")
"""The folder of studies on a server."""

PORT: Final = 8000

_LABEL: Final = r"[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?"
_HOST: Final = re.compile(rf"({_LABEL}\.)*{_LABEL}")
_MAX_HOST_LENGTH: Final = 253
_NAME: Final = re.compile(r"[a-z0-9]([a-z0-9-]{0,30}[a-z0-9])?")
_MAIL: Final = re.compile(r"[A-Za-z0-9._+-]{1,64}@(.+)")
_UNSAFE: Final = re.compile(r"""[\x00-\x1f\x7f"'`$\\]""")
"""Characters that a folder's name must not contain, since not every file can quote them."""


_HIDDEN: Final = ("/home", "/root", "/run/user")
"""Folders that ``ProtectHome`` hides from a service."""


def _one_line(title: str) -> str:
    """Return `title` in a form that systemd can show within quotes."""
    words = " ".join(title.split())
    return "".join(c for c in words if c.isprintable()).replace('"', "'").replace("\\", "/")


def _check_folder(folder: PurePosixPath) -> PurePosixPath:
    if not folder.is_absolute() or ".." in folder.parts or _UNSAFE.search(str(folder)):
        raise InputError(
            "a service cannot use this folder",
            where=f"folder {str(folder)!r}",
            remedy="Give the absolute path on the server, without quotes, $ and \\",
        )
    if any(map(folder.is_relative_to, _HIDDEN)):
        raise InputError(
            "a service cannot see this folder",
            where=f"folder {str(folder)!r}",
            remedy=f"Give its place on the server (--folder-there), such as {STUDIES}/gestures-2",
        )
    if _NAME.fullmatch(_service_name(folder)) is None:
        raise InputError(
            "no service or database can be named after this folder",
            where=f"folder {str(folder)!r}",
            remedy="On the server, use a name of up to 32 letters a to z, digits and '-', such as "
            f"{STUDIES}/gestures-2",
        )
    return folder


def _service_name(folder: PurePosixPath) -> str:
    return folder.name.lower().replace("_", "-").replace(" ", "-")


def _check_host(text: str) -> str:
    host = text.lower()
    is_number = host.rpartition(".")[2].isdigit()
    if _HOST.fullmatch(host) is None or len(host) > _MAX_HOST_LENGTH or is_number:
        raise InputError(
            "this is not a host name",
            where=f"host {text!r}",
            remedy="Give only the name, such as study.example.org, without https://, port and "
            "path; write letters other than a to z in the form xn--…",
        )
    return host


def _check_mail(text: str) -> str:
    match = _MAIL.fullmatch(text)
    if text and (match is None or _HOST.fullmatch(match[1].lower()) is None):
        raise InputError(
            "this is not an e-mail address",
            where=f"contact {text!r}",
            remedy="Give one such as ada@example.org",
        )
    return text


class Deployment(BaseModel):
    """One study or desk on one server; `InputError` if a value does not fit into its files.

    Attributes
    ----------
    kind : str
        ``study``, or ``desk`` for a folder of studies; templates call either one `study`.
    title : str
        The study's title, made one line; a desk's is its folder's name.
    folder : PurePosixPath
        The folder on the server, which names the service, files and database.
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

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["study", "desk"] = "study"
    title: Annotated[str, AfterValidator(_one_line)]
    folder: Annotated[PurePosixPath, AfterValidator(_check_folder)]
    host: Annotated[str, AfterValidator(_check_host)]
    prefix: Annotated[str, AfterValidator(checked_prefix)] = ""
    proxy: Proxy = "caddy"
    database: DatabaseKind = "sqlite"
    contact: Annotated[str, AfterValidator(_check_mail)] = ""
    port: int = PORT
    installed: PurePosixPath = PurePosixPath("/opt/motionjury")

    @property
    def name(self) -> str:
        """Names the study's service, files and database on the server."""
        return _service_name(self.folder)

    @property
    def command(self) -> str:
        """The command that serves it."""
        return "serve" if self.kind == "study" else "desk"

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


@dataclass(frozen=True, kw_only=True)
class DeployedFile:
    """A file for a server.

    Attributes
    ----------
    name, text : str
    place : str
        Its path on the server; empty if it is used from the folder of these files.
    """

    name: str
    text: str
    place: str

    @property
    def mode(self) -> int:
        """Its permissions."""
        return {"environment": 0o600, "command": 0o755, "install": 0o755}.get(self.name, 0o644)


def deployed_files(study: Deployment) -> tuple[DeployedFile, ...]:
    """Return all files of a deployment."""
    unit = f"/etc/systemd/system/{study.unit}"
    places = {
        "serve.service": f"{unit}.service",
        "environment": f"/etc/motionjury/{study.name}.env",
        "backup.service": f"{unit}-backup.service",
        "backup.timer": f"{unit}-backup.timer",
        "journald.conf": "/etc/systemd/journald.conf.d/motionjury.conf",
        "command": f"/usr/local/sbin/{study.unit}",
    }
    if study.proxy == "caddy":
        places["Caddyfile"] = "/etc/caddy/Caddyfile"
        places["study.caddy"] = f"/etc/caddy/motionjury/{study.name}.caddy"
    else:
        places["host.nginx"] = f"/etc/nginx/conf.d/{study.host}.conf"
        places["study.nginx"] = f"/etc/nginx/motionjury/{study.host}/{study.name}.conf"
    if study.database == "postgresql":
        places["database.sql"] = ""
    places |= {"Containerfile": "", "install": ""}
    files: list[DeployedFile] = []
    for name, place in places.items():
        # The last one, which installs the others, lists them.
        text = _templates(Path(name).suffix).get_template(name).render(study=study, files=files)
        files.append(DeployedFile(name=name, text=text, place=place))
    return tuple(files)


@cache
def _templates(ending: str) -> Environment:
    """Return the templates with this ending.

    What could not be quoted in every file is in no `Deployment`; only systemd's units read ``%``.
    """
    is_unit = ending in (".service", ".timer")
    return Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: str(value).replace("%", "%%") if is_unit else value,
        autoescape=False,  # noqa: S701 - none of the files is HTML
    )


def write_deployment(study: Deployment, out: Path) -> tuple[DeployedFile, ...]:
    """Write all files of a deployment into the folder `out`, and return them.

    Each is created with the permissions that it needs on the server.

    Raises
    ------
    InputError
        If the folder is not empty: files that were edited are never overwritten.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(
            "the folder is not empty",
            where=out,
            remedy="Choose a new folder (--out), and compare the two",
        )
    out.mkdir(parents=True, exist_ok=True)
    files = deployed_files(study)
    for file in files:
        path = out / file.name
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, file.mode)
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(file.text)
        path.chmod(file.mode)
    return files
