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

COMMON_WORDS: Final = frozenset(
    """
    account admin administrator animation baseball changeme computer default dragon experiment
    football gesture gestures hello iloveyou institute letmein login master monkey motion
    motionjury myaccount mypassword newpassword nothing owner participant passphrase passw0rd
    password princess qwerty research researcher sample science secret shadow starwars study
    summer sunshine superman superuser survey temporary test testing trustno1 university user
    welcome winter
    """.split()  # noqa: SIM905 - a list of one word a line is no easier to read
)
"""They count for nothing in a password."""

COMMON_RUNS: Final = (
    "01234567890123456789",
    "98765432109876543210",
    "abcdefghijklmnopqrstuvwxyz",
    "qwertyuiopasdfghjklzxcvbnm",
    "qwertzuiopasdfghjklyxcvbnm",
    "azertyuiopqsdfghjklmwxcvbn",
    "zyxwvutsrqponmlkjihgfedcba",
    "1q2w3e4r5t6y7u8i9o0p",
    "1qaz2wsx3edc4rfv5tgb6yhn7ujm8ik",
    "qazwsxedcrfvtgbyhnujmikolp",
)
"""Rows of keys and of letters; their parts count for nothing either."""


SHORTEST: Final = 12
LONGEST: Final = 256
FEWEST_LETTERS: Final = 5
"""That differ, and that are no part of what is common."""

HASHER: Final = PasswordHasher()
"""Argon2id with the library's parameters, those of RFC 9106 for little memory (64 MiB)."""

PARTS_OF_RUNS: Final = re.compile(
    "|".join(sorted({run[i : i + 4] for run in COMMON_RUNS for i in range(len(run) - 3)}))
)

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
    """Tell whether little is left of the password without what everybody tries first."""
    folded = password.casefold()
    if len(set(folded)) < FEWEST_LETTERS:
        return True
    left = plain = _letters(folded)
    for word in sorted({*COMMON_WORDS, _letters(name_key(name))} - {""}, key=len, reverse=True):
        left = left.replace(word, "")
    left = PARTS_OF_RUNS.sub("", left)
    if not plain.isdigit():
        left = re.sub(r"^\d+|\d+$", "", left)
    return len(left) < FEWEST_LETTERS


def _letters(text: str) -> str:
    """Return the letters and digits of `text` alone."""
    return re.sub(r"[\W_]", "", text)
