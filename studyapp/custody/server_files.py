"""The files of a deployment: what each is called, where it goes, and what stands in it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from motion.errors import InputError
from studyapp.custody.deployment import Deployment


def in_unit(text: str) -> str:
    """Return `text` for a quoted value of systemd's units; ``%`` begins a specifier there."""
    return _behind_backslashes(" ".join(text.split())).replace("%", "%%")


def in_proxy(text: str) -> str:
    """Return `text` for a quoted value of Caddy's or nginx's files."""
    return _behind_backslashes(text)


def in_script(text: str) -> str:
    """Return `text` for between two single quotes of a shell script."""
    return text.replace("'", "'\\''")


def in_sql(text: str) -> str:
    """Return `text` for a quoted name or string of SQL."""
    return text.replace('"', '""').replace("'", "''")


def _behind_backslashes(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


ESCAPES: Final[Mapping[str, Callable[[str], str]]] = MappingProxyType(
    {
        **dict.fromkeys((".service", ".timer"), in_unit),
        **dict.fromkeys((".caddy", ".nginx"), in_proxy),
        ".sh": in_script,
        ".sql": in_sql,
        # These hold nothing but values of a known alphabet.
        **dict.fromkeys((".env", ".conf", ".container"), str),
    }
)
"""How a value is written so that it stays one value, by the ending of a template.

Templates put a value that could hold anything within double quotes (in scripts, single ones).
"""

TEMPLATES: Final = Path(__file__).parent / "templates"


@dataclass(frozen=True, kw_only=True)
class DeployedFile:
    """One file.

    Attributes
    ----------
    name : str
        By which it is asked for.
    text : str
    place : PurePosixPath or None
        Where it goes on the server; None where it stays beside the others and is used from there.
    mode : int
        Who may read, write and run it there.
    keeps : bool
        Whether one that is there already stays: people write into it.
    """

    name: str
    text: str
    place: PurePosixPath | None
    mode: int
    keeps: bool = False


@dataclass(frozen=True)
class _Kind:
    """A kind of file: its place on the server may name attributes of the deployment."""

    name: str
    place: str = ""
    _: KW_ONLY
    template: str = ""
    needs: tuple[str, str] | None = None
    mode: int = 0o644
    keeps: bool = False

    def belongs_to(self, deployment: Deployment) -> bool:
        return self.needs is None or getattr(deployment, self.needs[0]) == self.needs[1]


_CADDY: Final = ("proxy", "caddy")
_NGINX: Final = ("proxy", "nginx")
KINDS: Final = (
    _Kind("serve.service", "/etc/systemd/system/{d.unit}.service"),
    _Kind(
        "environment",
        "/etc/motionjury/{d.name}.env",
        template="environment.env",
        mode=0o600,
        keeps=True,
    ),
    _Kind("backup.service", "/etc/systemd/system/{d.unit}-backup.service"),
    _Kind("backup.timer", "/etc/systemd/system/{d.unit}-backup.timer"),
    _Kind("journald.conf", "/etc/systemd/journald.conf.d/motionjury.conf"),
    _Kind("command", "/usr/local/sbin/{d.unit}", template="command.sh", mode=0o755),
    _Kind("Caddyfile", "/etc/caddy/Caddyfile", template="host.caddy", needs=_CADDY),
    _Kind("study.caddy", "/etc/caddy/motionjury/{d.name}.caddy", needs=_CADDY),
    _Kind("host.nginx", "/etc/nginx/conf.d/{d.host}.conf", needs=_NGINX),
    _Kind("study.nginx", "/etc/nginx/motionjury/{d.host}/{d.name}.conf", needs=_NGINX),
    _Kind("database.sql", needs=("database", "postgresql")),
    _Kind("Containerfile", template="image.container"),
    _Kind("install", template="install.sh", mode=0o755),
)


def deployed_files(deployment: Deployment) -> tuple[DeployedFile, ...]:
    """Return all files of `deployment`."""
    *kinds, install = (kind for kind in KINDS if kind.belongs_to(deployment))
    installed = tuple(_made(kind, deployment) for kind in kinds)
    return (*installed, _made(install, deployment, files=installed))


def _made(
    kind: _Kind, deployment: Deployment, *, files: tuple[DeployedFile, ...] = ()
) -> DeployedFile:
    template = kind.template or kind.name
    text = _environment(Path(template).suffix).get_template(template)
    return DeployedFile(
        name=kind.name,
        text=text.render(study=deployment, files=files),
        place=PurePosixPath(kind.place.format(d=deployment)) if kind.place else None,
        mode=kind.mode,
        keeps=kind.keeps,
    )


@cache
def _environment(ending: str) -> Environment:
    """Return what renders templates of one kind: each value is escaped for that kind of file."""
    escape = ESCAPES[ending]
    return Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: escape(str(value)),
        # What is made are files of a server, of which none is HTML.
        autoescape=False,  # noqa: S701
    )


def write_deployment(deployment: Deployment, out: Path) -> tuple[DeployedFile, ...]:
    """Write all files of `deployment` into the folder `out`, and return them.

    Each has the mode that it needs on the server from its first byte on.

    Raises
    ------
    InputError
        If there is anything in the folder yet: what was changed by hand is never overwritten.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(
            "there is something already",
            where=out,
            remedy="Name a new folder with --out, and compare the two",
        )
    out.mkdir(parents=True, exist_ok=True)
    files = deployed_files(deployment)
    for file in files:
        _write(out / file.name, file)
    return files


def _write(path: Path, file: DeployedFile) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, file.mode)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(file.text)
    path.chmod(file.mode)
