"""What a folder for another lab says of itself: its page, and what program made it."""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import Any, Final

from studyapp.results.export.codebook import written_page
from studyapp.study.settings.study import Study

PROGRAM: Final = "motionjury"
_MOTION: Final = 'extra == "motion"'
"""Marks what makes and renders motion; where that is installed, motion depends on it."""

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
            wanted = "extra ==" not in line or (name == PROGRAM and _MOTION in line)
            if needed is not None and wanted:
                waiting.append(_usual(needed.group()))
    return dict(sorted(found.items()))


def _usual(name: str) -> str:
    """Return a package's name as it is compared."""
    return re.sub(r"[-_.]+", "-", name).lower()


def read_me(study: Study, *, people: int, study_folder: str) -> str:
    """Return what the folder holds, and how its results are repeated."""
    return written_page(
        "read_me.md",
        title=" ".join(study.title.split()),
        protocol=study.protocol,
        people=people,
        study_folder=study_folder,
    )
