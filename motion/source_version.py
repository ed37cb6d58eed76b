"""Versions that follow the code: what was made with other code no longer fits."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable, Iterator
from importlib import metadata
from pathlib import Path
from typing import Final

_ROOT: Final = Path(__file__).resolve().parent.parent


def imported_sources(modules: Iterable[str]) -> tuple[str, ...]:
    """Return the source files of `modules` and of all they import of this project, sorted.

    The sources are read, not run. Imports within functions count; a package's ``__init__`` counts
    only where the package itself is imported.

    Parameters
    ----------
    modules : iterable of str
        Full names, such as ``renderer.pair``.

    Returns
    -------
    tuple of str
        Paths from the folder that holds the packages.
    """
    found: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        source = _source_of(name)
        if source is None or name in found:
            continue
        found[name] = source.relative_to(_ROOT).as_posix()
        waiting.extend(_imported_names(source))
    return tuple(sorted(found.values()))


def _source_of(module: str) -> Path | None:
    """Return the file of a module of this project; None for any other name."""
    place = _ROOT.joinpath(*module.split("."))
    candidates = (place.with_name(f"{place.name}.py"), place / "__init__.py")
    return next((path for path in candidates if path.is_file()), None)


def _imported_names(source: Path) -> Iterator[str]:
    """Yield every name that a source file may import as a module."""
    for node in ast.walk(ast.parse(source.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def source_version(patterns: Iterable[str], packages: Iterable[str] = ()) -> str:
    """Return a short text that changes with source files and package versions.

    Parameters
    ----------
    patterns : iterable of str
        Source files, or glob patterns of them, from the folder that holds the packages.
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
