"""Completion codes: drawing them, and telling which could be guessed."""

from __future__ import annotations

import re
import secrets
from typing import Final

CODE_LETTERS: Final = "ABCDEFGHJKMNPQRTUVWXYZ2346789"
"""Letters and digits that are not taken for one another."""

CODE_LENGTH: Final = 12

SHORTEST: Final = 8
FEWEST_DIFFERENT: Final = 5
LONGEST_RUN: Final = 3
ROWS: Final = ("abcdefghijklmnopqrstuvwxyz", "01234567890", "qwertyuiop", "asdfghjkl", "zxcvbnm")
WORDS: Final = (
    *("attention", "check", "code", "complete", "done", "finish", "motion", "pass", "prolific"),
    *("screen", "secret", "study", "success", "survey", "test", "thank", "fail"),
)


def draw_code() -> str:
    """Return a code that nobody can guess (58 random bits)."""
    while True:
        code = "".join(secrets.choice(CODE_LETTERS) for _ in range(CODE_LENGTH))
        if guessable(code) is None:
            return code


def guessable(code: str) -> str | None:
    """Say why `code` could be guessed, None if it could not."""
    plain = code.casefold()
    if len(code) < SHORTEST:
        return f"has fewer than {SHORTEST} characters"
    if len(set(plain)) < FEWEST_DIFFERENT:
        return f"has fewer than {FEWEST_DIFFERENT} different characters"
    if word := next((word for word in WORDS if word in plain), None):
        return f"holds the word {word!r}"
    if _has_run(plain):
        return f"holds more than {LONGEST_RUN} characters in a row that follow one another"
    if re.fullmatch(r"(.+?)\1+", plain):
        return "repeats itself"
    return None


def _has_run(plain: str) -> bool:
    """Tell whether letters or digits stand together as in the alphabet or on a keyboard."""
    pieces = (plain[at : at + LONGEST_RUN + 1] for at in range(len(plain) - LONGEST_RUN))
    rows = (*ROWS, *(row[::-1] for row in ROWS))
    return any(len(set(piece)) == 1 or any(piece in row for row in rows) for piece in pieces)
