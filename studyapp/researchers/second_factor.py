"""The second factor: codes that a researcher's own device makes (TOTP, RFC 6238)."""

from __future__ import annotations

import base64
import hmac
import secrets
from collections.abc import Callable
from datetime import datetime
from typing import Final

import pyotp
from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Researcher
from studyapp.researchers.account import researcher_named
from studyapp.researchers.attempts import count_attempt, forget_attempts
from studyapp.researchers.audit import log_change
from studyapp.researchers.names import name_hash
from studyapp.researchers.passwords import is_right
from studyapp.researchers.tokens import token_hash

STEP_SECONDS: Final = 30
STEPS_OFF: Final = (0, -1, 1)
"""Clocks may differ by so many steps."""

RECOVERY_CODES: Final = 8
RECOVERY_BYTES: Final = 10
SECRET_LETTERS: Final = 32

new_secret: Final = pyotp.random_base32
"""Returns 160 random bits, from which a device makes its codes."""


def address_for_device(secret: str, *, researcher: str, study: str) -> str:
    """Return the address that a device's program reads as a QR code."""
    return pyotp.TOTP(secret).provisioning_uri(name=researcher, issuer_name=f"Motion Jury {study}")


def passes(researcher: Researcher, code: str, now: datetime) -> bool:
    """Tell whether `code` is what the account asks for beside the password, and use it up.

    Without a second factor, nothing is asked for. The row must be kept from other writers.
    """
    if researcher.totp_secret is None:
        return True
    given = "".join(code.split()).casefold()
    step = _step(researcher.totp_secret, given, now)
    if step is not None and step > researcher.totp_step:
        researcher.totp_step = step
        return True
    recovery = token_hash(given.replace("-", ""))
    if recovery not in researcher.recovery_hashes:
        return False
    researcher.recovery_hashes = [h for h in researcher.recovery_hashes if h != recovery]
    return True


def turn_on(
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
        step = _step(secret, "".join(code.split()), now) if _is_secret(secret) else None
        if step is None:
            raise InputError(
                "the code is not the one that the device should show",
                remedy="Type the newest one; the device's clock must be right",
            )
        researcher.totp_secret, researcher.totp_step = secret, step
        researcher.recovery_hashes = [token_hash(each.replace("-", "")) for each in codes]
        return Event.SECOND_FACTOR_ON

    _change(database, clock, researcher_id, password, address, change)
    return codes


def turn_off(
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
        _remove(researcher)
        return Event.SECOND_FACTOR_OFF

    _change(database, clock, researcher_id, password, address, change)


def reset_second_factor(database: Database, clock: Clock, *, name: str) -> None:
    """Take the second factor from the researcher `name`, whose device is lost.

    Raises
    ------
    InputError
        If there is no such researcher.
    """
    with database.writing() as session:
        found = researcher_named(session, name)
        _remove(found)
        log_change(
            session, clock.now(), Event.SECOND_FACTOR_RESET, by="", detail=f"of {found.name}"
        )


def _change(
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
    if not is_right(seen.password_hash, password):
        raise InputError("the password is not right", remedy="Type it once more")
    with database.writing() as session:
        researcher = _kept(session, researcher_id)
        forget_attempts(session, name_hash(researcher.name), address)
        log_change(session, now, change(researcher, now), by=researcher.name)


def _kept(session: Session, researcher_id: int) -> Researcher:
    query = select(Researcher).where(Researcher.id == researcher_id).with_for_update()
    return session.scalars(query).one()


def _remove(researcher: Researcher) -> None:
    researcher.totp_secret, researcher.recovery_hashes = None, []


def _step(secret: str, code: str, now: datetime) -> int | None:
    """Return the time step of which `code` is the code; None of none near `now`."""
    present = int(now.timestamp()) // STEP_SECONDS
    made = pyotp.TOTP(secret)
    for off in STEPS_OFF:
        right = made.generate_otp(present + off)
        if hmac.compare_digest(right.encode(), code.encode()):
            return present + off
    return None


def _is_secret(text: str) -> bool:
    """Tell whether `text` is such as `new_secret` returns."""
    return len(text) == SECRET_LETTERS and set(text) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZ234567")


def _recovery_code() -> str:
    text = base64.b32encode(secrets.token_bytes(RECOVERY_BYTES)).decode().casefold()
    return "-".join(text[i : i + 4] for i in range(0, len(text), 4))
