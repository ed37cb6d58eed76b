"""Versions that follow the code: what was made with other code no longer fits."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Final

_ROOT: Final = Path(__file__).resolve().parent.parent


def source_version(patterns: Iterable[str], packages: Iterable[str] = ()) -> str:
    """Return a short text that changes with source files and package versions.

    Parameters
    ----------
    patterns : iterable of str
        Glob patterns of source files, from the folder that holds the packages.
    packages : iterable of str
        Installed distributions whose version matters too.
    """
    digest = hashlib.sha256()
    for pattern in patterns:
        for path in sorted(_ROOT.glob(pattern)):
            digest.update(path.relative_to(_ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    for package in packages:
        digest.update(f"{package}=={metadata.version(package)}".encode())
    return digest.hexdigest()[:12]
