"""One run of a command on a study at a time."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from motion.errors import InputError


@contextmanager
def held_alone(folder: Path, *, busy: InputError) -> Iterator[None]:
    """Hold a lock on `folder` during the block.

    The lock is the system's and lies on the folder itself: it leaves no file behind, and ends
    with the process that holds it, however that ends.

    Raises
    ------
    InputError
        `busy`, if another process holds it.
    """
    held = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise busy from None
        yield
    finally:
        os.close(held)
