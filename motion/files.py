"""Writing files in one step, so that an interruption leaves the old file or the new one."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path, *, private: bool = False) -> Iterator[Path]:
    """Give a temporary path beside `path` that takes its place when the block succeeds.

    Parameters
    ----------
    path : Path
        The file to be written; missing folders are made.
    private : bool
        Whether its owner alone may read it; else everybody who may read new files.

    Yields
    ------
    Path
        Where to write; it keeps the ending of `path`. Removed when the block fails.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        if not private:
            umask = os.umask(0)
            os.umask(umask)
            temporary.chmod(0o666 & ~umask)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str, *, private: bool = False) -> None:
    """Write UTF-8 `text` to `path` in one step, as `replacing` does."""
    with replacing(path, private=private) as temporary:
        temporary.write_text(text, encoding="utf-8")
