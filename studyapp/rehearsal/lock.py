"""One rehearsal of a study at a time."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder


@contextmanager
def only_rehearsal(folder: StudyFolder) -> Iterator[None]:
    """Keep other rehearsals of `folder` away during the block.

    The lock is the system's and lies on the folder itself: it leaves no file behind, and ends
    with the process that holds it, however that ends.

    Raises
    ------
    InputError
        If the study is being rehearsed already.
    """
    held = os.open(folder.root, os.O_RDONLY)
    try:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                "this study is being rehearsed already",
                where=folder.root,
                remedy="Wait until the other 'motionjury rehearse' is done, or stop it",
            ) from None
        yield
    finally:
        os.close(held)
