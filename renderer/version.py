"""What the pixels of a video depend on, as one short text."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Final

_ROOT: Final = Path(__file__).resolve().parent.parent


def digest_of_sources(patterns: Iterable[str], packages: Iterable[str]) -> str:
    """Return a digest of source files, given as patterns from the root, and package versions."""
    digest = hashlib.sha256()
    for pattern in patterns:
        for path in sorted(_ROOT.glob(pattern)):
            digest.update(path.relative_to(_ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    for package in packages:
        digest.update(f"{package}=={metadata.version(package)}".encode())
    return digest.hexdigest()[:12]


BODY_VERSION: Final = digest_of_sources(
    ("renderer/avatar/*.py", "motion/skeleton.py", "motion/face.py"), ("anny",)
)
"""Changes whenever the default body would."""

RENDERER_VERSION: Final = digest_of_sources(
    (
        "renderer/*.py",
        "renderer/avatar/*.py",
        "renderer/shaders/*",
        "motion/body.py",
        "motion/freeze.py",
        "motion/resample.py",
    ),
    ("anny", "av", "pyrender"),
)
"""Changes whenever the pixels or the sound of a video would, and sometimes when they would not."""
