"""Names of researchers: what may be one, and when two are the same."""

from __future__ import annotations

import hashlib
import unicodedata
from typing import Final

from motion.errors import InputError

SHORTEST: Final = 2
LONGEST: Final = 100


def settled_name(given: str) -> str:
    """Return the name as it is stored.

    Raises
    ------
    InputError
        If it is too short or too long, or holds what cannot be seen.
    """
    name = " ".join(unicodedata.normalize("NFC", given).split())
    if not SHORTEST <= len(name) <= LONGEST or not name.isprintable():
        raise InputError(
            f"a name has {SHORTEST} to {LONGEST} letters, and none that cannot be seen",
            remedy="Use your own name or your address of electronic mail",
        )
    return name


def name_key(name: str) -> str:
    """Return what is the same for all ways of writing one name.

    It is never longer than twice `LONGEST`, nor does it hold what a database cannot store.
    """
    folded = unicodedata.normalize("NFKC", " ".join(name.split())).casefold()
    seen = "".join(letter for letter in folded if letter.isprintable())
    return seen[: 2 * LONGEST]


def name_hash(name: str) -> str:
    """Return by what attempts to log in as `name` are counted."""
    return hashlib.sha256(name_key(name).encode("utf-8", "replace")).hexdigest()
