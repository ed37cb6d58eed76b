"""Running the analysis in a process of its own, which ends whatever becomes of it.

The analysis loads what a server must not: hundreds of megabytes, for seconds of work now and then.
So another process does it, of lower priority and with limits, and hands over its result as text.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import Final

from studyapp.researchers.interim.documents import What

PROGRAM: Final = "studyapp.results.so_far"
"""It belongs to a room above this one, and is called by name, as a stranger would."""

SECONDS: Final = 300
"""For 100,000 answers it takes about 15, and longer where it has to give way to others."""


class NoFiguresError(Exception):
    """Nothing was computed; the message says why, in sentences."""


@dataclass(frozen=True)
class FigureProcess:
    """Computes figures of one study.

    Attributes
    ----------
    folder : Path
        The study folder.
    database_url : str
        Where the answers are; handed over in the environment, since it may hold a password.
    """

    folder: Path
    database_url: str

    def begin(self, job: Callable[[], None]) -> None:
        """Have `job` done while the server goes on."""
        Thread(target=job, name="figures", daemon=True).start()

    def compute(self, what: What, *, seconds: float = SECONDS) -> str:
        """Return the document that the process hands over.

        Raises
        ------
        NoFiguresError
            If the process says why it cannot, fails, or takes too long.
        """
        # Without -P, a folder that happens to be called like a package would be taken for it.
        command = [sys.executable, "-P", "-m", PROGRAM, str(self.folder), what]
        environment = {
            **os.environ,
            "DATABASE_URL": self.database_url,
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        }
        try:
            done = subprocess.run(  # noqa: S603 - our own program
                command,
                env=environment,
                capture_output=True,
                text=True,
                timeout=seconds,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise NoFiguresError(
                f"It took longer than {seconds:g} seconds and was stopped. 'motionjury report' "
                "takes the time that it needs."
            ) from None
        except OSError as error:
            raise NoFiguresError(f"The process could not be started ({error.strerror}).") from error
        if done.returncode:
            said = done.stderr.strip().splitlines()
            raise NoFiguresError(said[-1] if said else f"It ended with {done.returncode}.")
        return done.stdout
