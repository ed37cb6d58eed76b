"""Researchers' credentials: passwords, second factors (TOTP, RFC 6238) and random tokens.

Of passwords, recovery codes and tokens, only hashes are stored. Login attempts are limited, so that
nobody can guess them. They are counted in the database for all server processes, by network address
and by address and name, so that strangers elsewhere lock nobody out. They are counted before the
password is compared, so that simultaneous attempts get no further than successive ones.
"""

import base64
import hashlib
import hmac
import math
import re
import secrets
import threading
import unicodedata
from base64 import b64encode
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime, timedelta
from typing import Final

import pyotp
from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError
from sqlalchemy import ColumnElement, and_, delete, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import APART, Clock
from studyapp.database.engine import Database
from studyapp.database.postgresql import Turn, take_turn
from studyapp.database.tables.researchers import Event, LoginAttempt, Researcher
from studyapp.researchers.account import find_researcher, name_hash, name_key
from studyapp.researchers.audit import log_change

TOKEN_BYTES: Final = 32


def new_token() -> str:
    """Return 256 random bits, safe in a URL."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def token_hash(token: str) -> str:
    """Return the stored hash of `token`; it is too random to need a slow hash like a password."""
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()


FIELD_WORDS: Final = (
    *("animation", "experiment", "gesture", "gestures", "institute", "jury", "motion"),
    *("motionjury", "participant", "research", "researcher", "study", "survey", "university"),
)
"""They are as easy to guess as the researcher's name."""

MIN_PASSWORD_LENGTH: Final = 12
MAX_PASSWORD_LENGTH: Final = 256
SCORED_LENGTH: Final = 72
"""Characters of a password that are scored; more take longer."""

REQUIRED_SCORE: Final = 4
"""zxcvbn's best score: more than 10 to the power of 10 guesses."""

HASHER: Final = PasswordHasher()
"""Argon2id with the library's parameters, those of RFC 9106 for little memory (64 MiB)."""

HASHING_SLOTS: Final = threading.BoundedSemaphore(2)
"""Limits the memory of simultaneous hashing."""

DUMMY_SALT: Final = b64encode(bytes(16)).rstrip(b"=").decode()
DUMMY_DIGEST: Final = b64encode(bytes(32)).rstrip(b"=").decode()


def check_password(password: str, *, name: str) -> None:
    """Raise `InputError` unless `password` may be chosen by the researcher `name`."""
    password = _normalize(password)
    if not MIN_PASSWORD_LENGTH <= len(password) <= MAX_PASSWORD_LENGTH:
        raise InputError(
            f"a password has {MIN_PASSWORD_LENGTH} to {MAX_PASSWORD_LENGTH} characters, "
            f"this one has {len(password)}",
            remedy="Several unrelated words are easy to remember",
        )
    if _is_common(password, name):
        raise InputError(
            "this password is among the first that anybody would try",
            remedy="Use several unrelated words",
        )


def hash_password(password: str) -> str:
    """Return the stored hash of `password`."""
    with HASHING_SLOTS:
        return HASHER.hash(_normalize(password))


def verify_password(password_hash: str | None, password: str) -> bool:
    """Tell whether `password` matches the stored hash.

    Without a hash, because nobody has that name, the same work is done: the response time must not
    reveal who has an account.
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
    """Tell whether the hash has outdated parameters."""
    return HASHER.check_needs_rehash(password_hash)


def _dummy_hash() -> str:
    """Return a hash that no password has, with the parameters in use."""
    costs = f"m={HASHER.memory_cost},t={HASHER.time_cost},p={HASHER.parallelism}"
    return f"$argon2id$v=19${costs}${DUMMY_SALT}${DUMMY_DIGEST}"


def _normalize(password: str) -> str:
    """Return the same text for all Unicode encodings of it."""
    return unicodedata.normalize("NFKC", password)


def _is_common(password: str, name: str) -> bool:
    """Tell whether the password is easy to guess, with or without spaces and punctuation."""
    # Imported late: its word lists take memory, and passwords are rarely chosen.
    from zxcvbn import zxcvbn  # type: ignore[import-untyped]

    known = [name_key(name), *name.split(), *FIELD_WORDS]
    written = (password, re.sub(r"[\W_]", "", password))
    return any(zxcvbn(each[:SCORED_LENGTH], known)["score"] < REQUIRED_SCORE for each in written)


WINDOW: Final = timedelta(minutes=15)
MAX_ATTEMPTS_PER_NAME: Final = 10
MAX_ATTEMPTS_PER_ADDRESS: Final = 50
"""Higher, as a whole institute may share one."""


class TooManyAttemptsError(InputError):
    """Logins from this address, or with this name from it, are blocked for some `seconds`."""

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        minutes = math.ceil(seconds / 60)
        super().__init__(
            "there were too many attempts to log in",
            remedy=f"Try again in {minutes} {'minute' if minutes == 1 else 'minutes'}, or ask an "
            "owner for a link to set a new password",
        )


def count_attempt(database: Database, name_hash: str, address: str, now: datetime) -> None:
    """Count one more attempt.

    Raises
    ------
    TooManyAttemptsError
        If there were too many with this name from this address, or from this address at all; this
        one is then not counted, so that waiting helps.
    """
    # Reading first: floods of attempts must not block participants' writes.
    with database.reading() as session:
        _require_few_attempts(session, name_hash, address, now)
    with database.writing() as session:
        take_turn(session.connection(), Turn.LOGIN)
        _require_few_attempts(session, name_hash, address, now)
        session.execute(delete(LoginAttempt).where(~_is_recent(now)))
        session.add(LoginAttempt(at=now, name_hash=name_hash, address=address))


def forget_attempts(session: Session, name_hash: str, address: str) -> None:
    """Forget the attempts with a name from `address`, after the right password."""
    session.execute(delete(LoginAttempt).where(_of_name_and_address(name_hash, address)))


def forget_all_attempts(session: Session, name_hash: str) -> None:
    """Forget all attempts with a name, after a change of the password."""
    session.execute(delete(LoginAttempt).where(LoginAttempt.name_hash == name_hash))


def _of_name_and_address(name_hash: str, address: str) -> ColumnElement[bool]:
    return and_(LoginAttempt.name_hash == name_hash, LoginAttempt.address == address)


def _is_recent(now: datetime) -> ColumnElement[bool]:
    """Return the condition that an attempt counts; one before a clock was set back does not."""
    return and_(LoginAttempt.at > now - WINDOW, LoginAttempt.at <= now + APART)


def _require_few_attempts(session: Session, name_hash: str, address: str, now: datetime) -> None:
    for condition, limit in (
        (_of_name_and_address(name_hash, address), MAX_ATTEMPTS_PER_NAME),
        (LoginAttempt.address == address, MAX_ATTEMPTS_PER_ADDRESS),
    ):
        end = _end_of_lockout(session, condition, limit, now)
        if end is not None:
            raise TooManyAttemptsError(max(1, math.ceil((end - now).total_seconds())))


def _end_of_lockout(
    session: Session, condition: ColumnElement[bool], limit: int, now: datetime
) -> datetime | None:
    """Return when fewer than `limit` attempts will count; None if fewer count now."""
    counted = (
        select(LoginAttempt.at)
        .where(condition, _is_recent(now))
        .order_by(LoginAttempt.at.desc())
        .offset(limit - 1)
        .limit(1)
    )
    oldest = session.scalar(counted)
    return None if oldest is None else oldest + WINDOW


STEP_SECONDS: Final = 30
ALLOWED_STEP_OFFSETS: Final = (0, -1, 1)
"""Allowed differences between clocks, in steps."""

RECOVERY_CODES: Final = 8
RECOVERY_BYTES: Final = 10
SECRET_LENGTH: Final = 32

new_secret: Final = pyotp.random_base32
"""Returns 160 random bits, from which a device computes its codes."""


def provisioning_uri(secret: str, *, researcher: str, study: str) -> str:
    """Return the address that an authenticator app reads as a QR code."""
    return pyotp.TOTP(secret).provisioning_uri(name=researcher, issuer_name=f"Motion Jury {study}")


def accept_code(researcher: Researcher, code: str, now: datetime) -> bool:
    """Use up `code`, a code of the second factor or a recovery code; tell whether it is valid.

    Without a second factor, any code is. The row must be locked.
    """
    if researcher.totp_secret is None:
        return True
    code = "".join(code.split()).casefold()
    step = _matching_step(researcher.totp_secret, code, now)
    if step is not None and step > researcher.totp_step:
        researcher.totp_step = step
        return True
    recovery = token_hash(code.replace("-", ""))
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
    """Turn the second factor on, and return the recovery codes, which are shown only once.

    Raises
    ------
    InputError
        If the password is wrong, or `code` is not a current code of `secret`.
    """
    with _changed_account(
        database, clock, researcher_id, password, address, Event.SECOND_FACTOR_ON
    ) as researcher:
        now = clock.now()
        step = _matching_step(secret, "".join(code.split()), now) if is_secret(secret) else None
        if step is None:
            raise InputError(
                "the code is wrong",
                remedy="Type the newest one, and check the device's clock",
            )
        codes = [_recovery_code() for _ in range(RECOVERY_CODES)]
        researcher.totp_secret, researcher.totp_step = secret, step
        researcher.recovery_hashes = [token_hash(each.replace("-", "")) for each in codes]
    return codes


def disable_second_factor(
    database: Database, clock: Clock, researcher_id: int, *, password: str, address: str
) -> None:
    """Turn the second factor off; `InputError` if the password is wrong."""
    with _changed_account(
        database, clock, researcher_id, password, address, Event.SECOND_FACTOR_OFF
    ) as researcher:
        _remove_second_factor(researcher)


def reset_second_factor(database: Database, clock: Clock, *, name: str) -> None:
    """Turn the second factor of the researcher `name` off, whose device is lost."""
    with database.writing() as session:
        researcher = find_researcher(session, name)
        _remove_second_factor(researcher)
        detail = f"of {researcher.name}"
        log_change(session, clock.now(), Event.SECOND_FACTOR_RESET, by="", detail=detail)


def prove_password(
    database: Database, researcher_id: int, password: str, address: str, now: datetime
) -> Researcher:
    """Count an attempt, and return the account; `InputError` if the password is wrong."""
    with database.reading() as session:
        account = session.get_one(Researcher, researcher_id)
    count_attempt(database, name_hash(account.name), address, now)
    if not verify_password(account.password_hash, password):
        raise InputError("the password is wrong", remedy="Type it again")
    return account


@contextmanager
def _changed_account(
    database: Database, clock: Clock, researcher_id: int, password: str, address: str, event: Event
) -> Iterator[Researcher]:
    """Give the account to be changed once the password has proved right, and log the change."""
    now = clock.now()
    prove_password(database, researcher_id, password, address, now)
    with database.writing() as session:
        researcher = session.get_one(Researcher, researcher_id, with_for_update=True)
        yield researcher
        forget_attempts(session, name_hash(researcher.name), address)
        log_change(session, now, event, by=researcher.name)


def _remove_second_factor(researcher: Researcher) -> None:
    researcher.totp_secret, researcher.recovery_hashes = None, []


def _matching_step(secret: str, code: str, now: datetime) -> int | None:
    """Return the time step near `now` whose code is `code`, or None."""
    present = int(now.timestamp()) // STEP_SECONDS
    totp = pyotp.TOTP(secret)
    for offset in ALLOWED_STEP_OFFSETS:
        expected = totp.generate_otp(present + offset)
        if hmac.compare_digest(expected.encode(), code.encode()):
            return present + offset
    return None


def is_secret(text: str) -> bool:
    """Tell whether `text` has the form of a secret."""
    return len(text) == SECRET_LENGTH and set(text) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZ234567")


def _recovery_code() -> str:
    text = base64.b32encode(secrets.token_bytes(RECOVERY_BYTES)).decode().casefold()
    return "-".join(text[i : i + 4] for i in range(0, len(text), 4))
