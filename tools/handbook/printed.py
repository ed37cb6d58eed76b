"""What commands print, as a page shows it: the same at each run, and short."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

_PROGRESS: Final = re.compile(r"[\w ]+: \d+ of \d+ \w+(, .*)?")
_ONE_TIME_LINK: Final = re.compile(r"(/research/(?:join|password)/|/try/\?invitation=)[\w-]+")
_KEPT: Final = re.compile(r"(\d+)\+(\d+)")
LEFT_OUT: Final = "…"


def steady(output: str, folder: Path) -> list[str]:
    """Return the lines without what differs from run to run.

    Progress and its rates are left out, one-time links are shortened, and `folder`, in which the
    commands ran, is not named.
    """
    lines = []
    for line in output.splitlines():
        text = line.rstrip().replace(f"{folder}/", "")
        if not _PROGRESS.fullmatch(text):
            lines.append(_ONE_TIME_LINK.sub(rf"\g<1>{LEFT_OUT}", text))
    return lines


def shortened(lines: list[str], kept: str) -> list[str]:
    """Return the first and the last of many lines.

    Parameters
    ----------
    lines : list of str
        All of them.
    kept : str
        How many, such as ``6+2``.
    """
    found = _KEPT.fullmatch(kept)
    if found is None:
        raise ValueError(f"{kept!r} says not how many lines to keep; write it as 6+2")
    first, last = map(int, found.groups())
    if len(lines) <= first + last + 1:
        return lines
    return [*lines[:first], LEFT_OUT, *lines[len(lines) - last :]]
