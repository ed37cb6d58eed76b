"""What a folder for another lab says of itself: its page, and what program made it."""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import Any, Final

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
    return f"""\
# {" ".join(study.title.split())}

Answers of {people} participants of a {study.protocol} study, made with Motion Jury. The folder
follows BIDS for behavioural data; what BIDS has no place for is in `sourcedata`.

```
participants.tsv            who took part, and whom the analysis leaves out, by which rule
sub-*/beh/*_beh.tsv         one row for each answer, with sides, times and what was watched
phenotype/form.tsv          what participants said about themselves
sourcedata/study            the study: its file as it was, speech, motion, and the answers
sourcedata/stimuli.tsv      every video that was shown, with its SHA-256
sourcedata/watching.tsv     how each video was watched
sourcedata/versions         every version of the study file, and the digests of their designs
sourcedata/codebook.md      what columns and values mean, and the wording of the questions
sourcedata/environment.json the versions of all packages
SHA256SUMS                  of every file; `sha256sum --check SHA256SUMS` compares them
```

## Repeating the results

With the same version of Motion Jury and of the packages that `sourcedata/environment.json` lists,

    motionjury report {study_folder}

writes `{study_folder}/report/results.json` again, byte for byte. Where `sourcedata/results.json` is
there, it is the one of the lab that made this folder.

## Who is in it

Participants are named by pseudonyms. They are keyed hashes: without the key, which is not here,
they lead back to nobody. There are no dates but the days on which researchers looked at results
(`shared_answers/looks.csv`): times are seconds since a participant's consent. Of who withdrew, only
the number is here. `study_session` counts participants in the order in which they came; the report
names them by it.
"""
