"""Passwords: which are accepted, and how they are kept and compared."""

from __future__ import annotations

import re
import threading
import unicodedata
from base64 import b64encode
from typing import Final

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from motion.errors import InputError
from studyapp.researchers.names import name_key

WORDS_OF_THE_FIELD: Final = (
    *("animation", "experiment", "gesture", "gestures", "institute", "jury", "motion"),
    *("motionjury", "participant", "research", "researcher", "study", "survey", "university"),
)
"""They are as easy to guess as the researcher's own name."""

SHORTEST: Final = 12
LONGEST: Final = 256
JUDGED: Final = 72
"""Characters of a password that are judged; it takes longer the more there are."""

SAFE: Final = 4
"""zxcvbn's best score: more than 10 to the power of 10 guesses."""

HASHER: Final = PasswordHasher()
"""Argon2id with the library's parameters, those of RFC 9106 for little memory (64 MiB)."""

TWO_AT_ONCE: Final = threading.BoundedSemaphore(2)
"""Each hash takes memory: very many logins at once must not take all there is."""

OF_NOBODY: Final = b64encode(bytes(16)).rstrip(b"=").decode()
DIGEST_OF_NOTHING: Final = b64encode(bytes(32)).rstrip(b"=").decode()


def check_password(password: str, *, name: str) -> None:
    """Raise `InputError` unless `password` may be chosen by the researcher `name`."""
    password = _normal(password)
    if not SHORTEST <= len(password) <= LONGEST:
        raise InputError(
            f"a password has {SHORTEST} to {LONGEST} characters, this one has {len(password)}",
            remedy="Several words that you do not usually say together are easy to remember",
        )
    if _is_common(password, name):
        raise InputError(
            "this password is among the first that anybody would try",
            remedy="Take several words that you do not usually say together",
        )


def hashed(password: str) -> str:
    """Return what is stored of `password`."""
    with TWO_AT_ONCE:
        return HASHER.hash(_normal(password))


def is_right(password_hash: str | None, password: str) -> bool:
    """Tell whether `password` is the one whose hash is stored.

    Where there is none, because nobody has that name, as much is computed all the same: how long
    the answer takes must not tell who has an account.
    """
    with TWO_AT_ONCE:
        try:
            HASHER.verify(password_hash or _hash_of_nobody(), _normal(password)[:LONGEST])
        except (VerificationError, InvalidHashError):
            return False
    return password_hash is not None


def is_outdated(password_hash: str) -> bool:
    """Tell whether the hash was made with other parameters than those in use."""
    return HASHER.check_needs_rehash(password_hash)


def _hash_of_nobody() -> str:
    """Return a hash that no password has, of the parameters in use."""
    costs = f"m={HASHER.memory_cost},t={HASHER.time_cost},p={HASHER.parallelism}"
    return f"$argon2id$v=19${costs}${OF_NOBODY}${DIGEST_OF_NOTHING}"


def _normal(password: str) -> str:
    """Return the same for all ways in which keyboards encode what was typed."""
    return unicodedata.normalize("NFKC", password)


def _is_common(password: str, name: str) -> bool:
    """Tell whether few guesses find the password, with its spaces and punctuation or without."""
    # Its lists of words take memory, and passwords are chosen seldom.
    from zxcvbn import zxcvbn  # type: ignore[import-untyped]

    known = [name_key(name), *name.split(), *WORDS_OF_THE_FIELD]
    written = (password, re.sub(r"[\W_]", "", password))
    return any(zxcvbn(each[:JUDGED], known)["score"] < SAFE for each in written)
