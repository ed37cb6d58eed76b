"""Which program, and which packages, an export was made with."""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import Any, Final

PROGRAM: Final = "motionjury"
_NAME: Final = re.compile(r"[A-Za-z0-9._-]+")


def environment() -> dict[str, Any]:
    """Return versions of the program, of Python, and of all packages that the program needs."""
    return {
        PROGRAM: metadata.version(PROGRAM),
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "packages": dict(_packages()),
    }


@cache
def _packages() -> Mapping[str, str]:
    """Return the version of each package; they stay the same while the program runs."""
    found: dict[str, str] = {}
    absent: set[str] = set()
    waiting = [PROGRAM]
    while waiting:
        name = waiting.pop()
        if name in found or name in absent:
            continue
        try:
            package = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            absent.add(name)  # for another system, or optional
            continue
        # Read once: every look at a package's metadata parses all of it.
        about = package.metadata
        found[name] = about["Version"]
        for line in about.get_all("Requires-Dist") or ():
            needed = _NAME.match(line)
            if needed is not None and "extra ==" not in line:
                waiting.append(_usual(needed.group()))
    return dict(sorted(found.items()))


def _usual(name: str) -> str:
    """Return a package's name as it is compared."""
    return re.sub(r"[-_.]+", "-", name).lower()
