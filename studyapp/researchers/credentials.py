"""What researchers show who they are by: passwords, codes of a device, and random tokens.

Of each, only what cannot be turned back is stored. The codes are TOTP (RFC 6238).
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import re
import secrets
import threading
import unicodedata
from base64 import b64encode
from collections.abc import Callable
from datetime import datetime
from typing import Final

import pyotp
from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError
from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Researcher
from studyapp.researchers.account import find_researcher, name_hash, name_key
from studyapp.researchers.attempts import count_attempt, forget_attempts
from studyapp.researchers.audit import log_change

TOKEN_BYTES: Final = 32


def new_token() -> str:
    """Return 256 random bits as letters that an address may hold."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def token_hash(token: str) -> str:
    """Return what is stored of `token`, from which nobody can tell it.

    It is random enough that a plain hash cannot be guessed backwards, unlike that of a password.
    """
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()


FIELD_WORDS: Final = (
    *("animation", "experiment", "gesture", "gestures", "institute", "jury", "motion"),
    *("motionjury", "participant", "research", "researcher", "study", "survey", "university"),
)
"""They are as easy to guess as the researcher's own name."""

MIN_PASSWORD_LENGTH: Final = 12
MAX_PASSWORD_LENGTH: Final = 256
SCORED_LENGTH: Final = 72
"""Characters of a password that are judged; it takes longer the more there are."""

REQUIRED_SCORE: Final = 4
"""zxcvbn's best score: more than 10 to the power of 10 guesses."""

HASHER: Final = PasswordHasher()
"""Argon2id with the library's parameters, those of RFC 9106 for little memory (64 MiB)."""

HASHING_SLOTS: Final = threading.BoundedSemaphore(2)
"""Each hash takes memory: very many logins at once must not take all there is."""

DUMMY_SALT: Final = b64encode(bytes(16)).rstrip(b"=").decode()
DUMMY_DIGEST: Final = b64encode(bytes(32)).rstrip(b"=").decode()


def check_password(password: str, *, name: str) -> None:
    """Raise `InputError` unless `password` may be chosen by the researcher `name`."""
    password = _normalize(password)
    if not MIN_PASSWORD_LENGTH <= len(password) <= MAX_PASSWORD_LENGTH:
        raise InputError(
            f"a password has {MIN_PASSWORD_LENGTH} to {MAX_PASSWORD_LENGTH} characters, "
            f"this one has {len(password)}",
            remedy="Several words that you do not usually say together are easy to remember",
        )
    if _is_common(password, name):
        raise InputError(
            "this password is among the first that anybody would try",
            remedy="Take several words that you do not usually say together",
        )


def hash_password(password: str) -> str:
    """Return what is stored of `password`."""
    with HASHING_SLOTS:
        return HASHER.hash(_normalize(password))


def verify_password(password_hash: str | None, password: str) -> bool:
    """Tell whether `password` is the one whose hash is stored.

    Where there is none, because nobody has that name, as much is computed all the same: how long
    the answer takes must not tell who has an account.
    """
    with HASHING_SLOTS:
        try:
            HASHER.verify(
                password_hash or _dummy_hash(), _normalize(password)[:MAX_PASSWORD_LENGTH]
            )
        except (VerificationError, InvalidHashError):
            return False
    return password_hash is not None


def needs_rehash(password_hash: str) -> bool:
    """Tell whether the hash was made with other parameters than those in use."""
    return HASHER.check_needs_rehash(password_hash)


def _dummy_hash() -> str:
    """Return a hash that no password has, of the parameters in use."""
    costs = f"m={HASHER.memory_cost},t={HASHER.time_cost},p={HASHER.parallelism}"
    return f"$argon2id$v=19${costs}${DUMMY_SALT}${DUMMY_DIGEST}"


def _normalize(password: str) -> str:
    """Return the same for all ways in which keyboards encode what was typed."""
    return unicodedata.normalize("NFKC", password)


def _is_common(password: str, name: str) -> bool:
    """Tell whether few guesses find the password, with its spaces and punctuation or without."""
    # Its lists of words take memory, and passwords are chosen seldom.
    from zxcvbn import zxcvbn  # type: ignore[import-untyped]

    known = [name_key(name), *name.split(), *FIELD_WORDS]
    written = (password, re.sub(r"[\W_]", "", password))
    return any(zxcvbn(each[:SCORED_LENGTH], known)["score"] < REQUIRED_SCORE for each in written)


STEP_SECONDS: Final = 30
ALLOWED_STEP_OFFSETS: Final = (0, -1, 1)
"""Clocks may differ by so many steps."""

RECOVERY_CODES: Final = 8
RECOVERY_BYTES: Final = 10
SECRET_LENGTH: Final = 32

new_secret: Final = pyotp.random_base32
"""Returns 160 random bits, from which a device makes its codes."""


def provisioning_uri(secret: str, *, researcher: str, study: str) -> str:
    """Return the address that a device's program reads as a QR code."""
    return pyotp.TOTP(secret).provisioning_uri(name=researcher, issuer_name=f"Motion Jury {study}")


def accept_code(researcher: Researcher, code: str, now: datetime) -> bool:
    """Tell whether `code` is what the account asks for beside the password, and use it up.

    Without a second factor, nothing is asked for. The row must be kept from other writers.
    """
    if researcher.totp_secret is None:
        return True
    given = "".join(code.split()).casefold()
    step = _matching_step(researcher.totp_secret, given, now)
    if step is not None and step > researcher.totp_step:
        researcher.totp_step = step
        return True
    recovery = token_hash(given.replace("-", ""))
    if recovery not in researcher.recovery_hashes:
        return False
    researcher.recovery_hashes = [h for h in researcher.recovery_hashes if h != recovery]
    return True


def enable_second_factor(
    database: Database,
    clock: Clock,
    researcher_id: int,
    *,
    secret: str,
    code: str,
    password: str,
    address: str,
) -> list[str]:
    """Ask for codes from now on, and return the recovery codes, which nobody can read again.

    Raises
    ------
    InputError
        If the password is not right, or `code` is not one that `secret` makes now.
    """
    codes = [_recovery_code() for _ in range(RECOVERY_CODES)]

    def change(researcher: Researcher, now: datetime) -> Event:
        step = _matching_step(secret, "".join(code.split()), now) if _is_secret(secret) else None
        if step is None:
            raise InputError(
                "the code is not the one that the device should show",
                remedy="Type the newest one; the device's clock must be right",
            )
        researcher.totp_secret, researcher.totp_step = secret, step
        researcher.recovery_hashes = [token_hash(each.replace("-", "")) for each in codes]
        return Event.SECOND_FACTOR_ON

    _change_second_factor(database, clock, researcher_id, password, address, change)
    return codes


def disable_second_factor(
    database: Database, clock: Clock, researcher_id: int, *, password: str, address: str
) -> None:
    """Ask for no codes any more.

    Raises
    ------
    InputError
        If the password is not right.
    """

    def change(researcher: Researcher, now: datetime) -> Event:
        del now
        _remove_second_factor(researcher)
        return Event.SECOND_FACTOR_OFF

    _change_second_factor(database, clock, researcher_id, password, address, change)


def reset_second_factor(database: Database, clock: Clock, *, name: str) -> None:
    """Take the second factor from the researcher `name`, whose device is lost.

    Raises
    ------
    InputError
        If there is no such researcher.
    """
    with database.writing() as session:
        found = find_researcher(session, name)
        _remove_second_factor(found)
        log_change(
            session, clock.now(), Event.SECOND_FACTOR_RESET, by="", detail=f"of {found.name}"
        )


def _change_second_factor(
    database: Database,
    clock: Clock,
    researcher_id: int,
    password: str,
    address: str,
    change: Callable[[Researcher, datetime], Event],
) -> None:
    """Change an account whose password is given once more, and log what was done."""
    now = clock.now()
    with database.reading() as session:
        seen = session.get_one(Researcher, researcher_id)
    count_attempt(database, name_hash(seen.name), address, now)
    if not verify_password(seen.password_hash, password):
        raise InputError("the password is not right", remedy="Type it once more")
    with database.writing() as session:
        researcher = _kept(session, researcher_id)
        forget_attempts(session, name_hash(researcher.name), address)
        log_change(session, now, change(researcher, now), by=researcher.name)


def _kept(session: Session, researcher_id: int) -> Researcher:
    query = select(Researcher).where(Researcher.id == researcher_id).with_for_update()
    return session.scalars(query).one()


def _remove_second_factor(researcher: Researcher) -> None:
    researcher.totp_secret, researcher.recovery_hashes = None, []


def _matching_step(secret: str, code: str, now: datetime) -> int | None:
    """Return the time step of which `code` is the code; None of none near `now`."""
    present = int(now.timestamp()) // STEP_SECONDS
    made = pyotp.TOTP(secret)
    for off in ALLOWED_STEP_OFFSETS:
        right = made.generate_otp(present + off)
        if hmac.compare_digest(right.encode(), code.encode()):
            return present + off
    return None


def _is_secret(text: str) -> bool:
    """Tell whether `text` is such as `new_secret` returns."""
    return len(text) == SECRET_LENGTH and set(text) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZ234567")


def _recovery_code() -> str:
    text = base64.b32encode(secrets.token_bytes(RECOVERY_BYTES)).decode().casefold()
    return "-".join(text[i : i + 4] for i in range(0, len(text), 4))
