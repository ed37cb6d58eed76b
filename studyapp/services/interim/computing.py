"""Running the analysis in a process of its own, which ends whatever becomes of it.

The analysis loads what a server must not: hundreds of megabytes, for seconds of work now and then.
So another process does it, of lower priority and with limits, and hands over its result as text.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

from motion.errors import InputError
from studyapp.services.interim.documents import What

PROGRAM: Final = "studyapp.stages.so_far_process"
"""It belongs to a room above this one, and is called by name, as a stranger would."""

SECONDS: Final = 120
"""For 100,000 answers it takes about 10."""


def compute(folder: Path, database_url: str, what: What, *, seconds: float = SECONDS) -> str:
    """Return the document that the process hands over.

    Parameters
    ----------
    folder : Path
        The study folder.
    database_url : str
        Where the answers are; handed over in the environment, since it may hold a password.
    what : {'agreement', 'results'}
        What is wanted.

    Raises
    ------
    InputError
        If the process says why it cannot, fails, or takes too long.
    """
    # Without -P, a folder that happens to be called like a package would be taken for it.
    command = [sys.executable, "-P", "-m", PROGRAM, str(folder), what]
    environment = {
        **os.environ,
        "DATABASE_URL": database_url,
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
    try:
        done = subprocess.run(  # noqa: S603 - our own program
            command, env=environment, capture_output=True, text=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        raise InputError(
            f"computing took longer than {seconds:g} seconds and was stopped",
            remedy="Run 'motionjury report' instead, on a machine with time for it",
        ) from None
    except OSError as error:
        raise InputError(
            f"the process could not be started ({error.strerror})",
            remedy="Look at how much memory the server has left",
        ) from error
    if done.returncode:
        said = done.stderr.strip().splitlines()
        raise InputError(
            said[-1] if said else f"the process ended with {done.returncode}",
            remedy="Look at what 'motionjury report' says",
        )
    return done.stdout
