"""Secrets that must never appear in a server's log."""

import re
from pathlib import Path
from typing import Final

SECRETS: Final = {
    "a traceback": re.compile(r"^Traceback|^  File \"", re.MULTILINE),
    "a participant's address": re.compile(r"/(take|media)/"),
    # 24 random bytes in base64; names of files and modules are shorter or have other characters.
    "a token": re.compile(r"(?<![A-Za-z0-9_-])[A-Za-z0-9_-]{32}(?![A-Za-z0-9_-])"),
    "a network address": re.compile(r"\b\d{1,3}(\.\d{1,3}){3}\b"),
    "a password": re.compile(r"://[^/\s:]+:[^*@\s]+@"),
}


def secrets_in(log: Path, *, allowed: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return the secrets in the file `log`, with the first position of each.

    Parameters
    ----------
    allowed : tuple of str
        Kinds of `SECRETS` to ignore.
    """
    text = log.read_text(encoding="utf-8", errors="replace")
    secrets = []
    for kind, pattern in SECRETS.items():
        match = None if kind in allowed else pattern.search(text)
        if match is not None:
            start = text.rfind("\n", 0, match.start()) + 1
            secrets.append(f"{kind}: {text[start : match.end()][-300:]}")
    return tuple(secrets)
