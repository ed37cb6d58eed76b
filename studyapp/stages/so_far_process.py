"""The process that computes figures of the answers so far: ``… FOLDER agreement|results``.

It writes the document to its output, and ends by itself whatever becomes of who started it.
"""

from __future__ import annotations

import os
import resource
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from pydantic import BaseModel

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.stages.so_far import agreement_so_far, results_so_far

DOCUMENTS: Final[dict[str, Callable[[StudyFolder], BaseModel]]] = {
    "agreement": agreement_so_far,
    "results": results_so_far,
}
PROCESSOR_SECONDS: Final = 120
LESS_URGENT: Final = 10
"""Than the server that participants wait for."""


def main(arguments: Sequence[str]) -> int:
    """Compute, print, and return the exit status."""
    folder, what = arguments
    try:
        document = DOCUMENTS[what](StudyFolder(Path(folder)))
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 1
    print(document.model_dump_json())
    return 0


if __name__ == "__main__":
    os.nice(LESS_URGENT)
    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
    sys.exit(main(sys.argv[1:]))
