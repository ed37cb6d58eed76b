"""Writing the files of a deployment into a folder of their own."""

from __future__ import annotations

import os
from pathlib import Path

from motion.errors import InputError
from studyapp.stages.deploying.deployment import Deployment
from studyapp.stages.deploying.files import DeployedFile, deployed_files


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
