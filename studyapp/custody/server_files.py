"""The files of a deployment: their names, targets and contents."""

from __future__ import annotations

import os
from dataclasses import KW_ONLY, dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from motion.errors import InputError
from studyapp.custody.deployment import Deployment

TEMPLATES: Final = Path(__file__).parent / "templates"


@dataclass(frozen=True, kw_only=True)
class DeployedFile:
    """A file for a server.

    Attributes
    ----------
    name : str
    text : str
    place : PurePosixPath or None
        Its path on the server; None if it is used from the folder of these files.
    mode : int
        Its permissions.
    keeps : bool
        Whether an existing file is kept, because people edit it.
    """

    name: str
    text: str
    place: PurePosixPath | None
    mode: int
    keeps: bool = False


@dataclass(frozen=True)
class _Kind:
    """A kind of file; braces in its place are attributes of the deployment."""

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
    installed = tuple(_render(kind, deployment) for kind in kinds)
    return (*installed, _render(install, deployment, files=installed))


def _render(
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
    """Return the environment for templates with this ending.

    What could not be quoted in every file is in no `Deployment`; only systemd's units read ``%``.
    """
    is_unit = ending in (".service", ".timer")
    return Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: str(value).replace("%", "%%") if is_unit else value,
        autoescape=False,  # noqa: S701 - none of the files is HTML
    )


def write_deployment(deployment: Deployment, out: Path) -> tuple[DeployedFile, ...]:
    """Write all files of `deployment` into the folder `out`, and return them.

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
    files = deployed_files(deployment)
    for file in files:
        _write(out / file.name, file)
    return files


def _write(path: Path, file: DeployedFile) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, file.mode)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(file.text)
    path.chmod(file.mode)
