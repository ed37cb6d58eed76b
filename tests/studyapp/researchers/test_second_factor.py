"""With a second factor, name and password alone open nothing."""

from __future__ import annotations

from contextlib import suppress
from datetime import timedelta

import pyotp
import pytest
from sqlalchemy import select

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import Researcher
from studyapp.researchers.attempts import MOST_OF_NAME, TooManyAttemptsError
from studyapp.researchers.authentication import WrongLoginError, log_in
from studyapp.researchers.links import choose_password, offer_new_password
from studyapp.researchers.second_factor import (
    address_for_device,
    new_secret,
    reset_second_factor,
    turn_off,
    turn_on,
)
from tests.studyapp.researchers_at_hand import HERE, PASSWORD, enter, joined
from tests.studyapp.taking_part_steps import SetClock

NEW = "seven quiet bicycles"


def code_of(secret: str, clock: SetClock, seconds: float = 0) -> str:
    return pyotp.TOTP(secret).at(clock.now() + timedelta(seconds=seconds))


def with_second_factor(database: Database, clock: SetClock) -> tuple[str, list[str]]:
    """Let Ada join and turn it on; return the device's secret, and the recovery codes."""
    number, secret = joined(database, clock, "Ada"), new_secret()
    code = code_of(secret, clock)
    codes = turn_on(
        database, clock, number, secret=secret, code=code, password=PASSWORD, address=HERE
    )
    clock.advance(seconds=30)
    return secret, codes


def enter_with(database: Database, clock: SetClock, code: str) -> str:
    return log_in(database, clock, name="Ada", password=PASSWORD, code=code, address=HERE)


def test_each_code_of_the_device_logs_in_once(database: Database, clock: SetClock) -> None:
    secret, _ = with_second_factor(database, clock)
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Ada")
    with pytest.raises(WrongLoginError):
        enter_with(database, clock, "000000")
    code = code_of(secret, clock)

    assert enter_with(database, clock, f"{code[:3]} {code[3:]}")

    with pytest.raises(WrongLoginError):
        enter_with(database, clock, code)
    clock.advance(seconds=30)
    assert enter_with(database, clock, code_of(secret, clock))


def test_a_clock_may_be_off_by_half_a_minute_and_no_more(
    database: Database, clock: SetClock
) -> None:
    secret, _ = with_second_factor(database, clock)

    with pytest.raises(WrongLoginError):
        enter_with(database, clock, code_of(secret, clock, 60))
    assert enter_with(database, clock, code_of(secret, clock, 30))


def test_a_recovery_code_logs_in_once_and_none_is_stored(
    database: Database, clock: SetClock
) -> None:
    _, codes = with_second_factor(database, clock)

    assert enter_with(database, clock, codes[0].upper())

    with pytest.raises(WrongLoginError):
        enter_with(database, clock, codes[0])
    assert enter_with(database, clock, codes[1].replace("-", " "))
    with database.reading() as session:
        kept = session.scalars(select(Researcher.recovery_hashes)).one()
    assert len(kept) == len(codes) - 2
    assert not set(kept) & set(codes)


def test_turning_it_on_or_off_needs_the_password_and_a_code_that_fits(
    database: Database, clock: SetClock
) -> None:
    number, secret = joined(database, clock, "Ada"), new_secret()
    code = code_of(secret, clock)
    for tried in ({"password": "wrong"}, {"code": "000000"}, {"secret": "short"}):
        given = {"secret": secret, "code": code, "password": PASSWORD} | tried
        with pytest.raises(InputError):
            turn_on(database, clock, number, **given, address=HERE)
    enter(database, clock, "Ada")
    turn_on(database, clock, number, secret=secret, code=code, password=PASSWORD, address=HERE)

    with pytest.raises(InputError):
        turn_off(database, clock, number, password="wrong", address=HERE)  # noqa: S106
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Ada")
    turn_off(database, clock, number, password=PASSWORD, address=HERE)
    enter(database, clock, "Ada")


def test_codes_cannot_be_guessed_on_and_on(database: Database, clock: SetClock) -> None:
    secret, _ = with_second_factor(database, clock)
    for number in range(MOST_OF_NAME):
        with suppress(WrongLoginError):
            enter_with(database, clock, f"{number:06}")

    with pytest.raises(TooManyAttemptsError):
        enter_with(database, clock, code_of(secret, clock))


def test_a_link_for_a_new_password_does_not_go_around_it(
    database: Database, clock: SetClock
) -> None:
    secret, _ = with_second_factor(database, clock)
    link = offer_new_password(database, clock, name="Ada", by="")

    assert choose_password(database, clock, link, password=NEW) is None

    code = code_of(secret, clock)
    assert log_in(database, clock, name="Ada", password=NEW, code=code, address=HERE)


def test_who_runs_the_server_takes_it_from_somebody_who_lost_the_device(
    database: Database, clock: SetClock
) -> None:
    with_second_factor(database, clock)

    reset_second_factor(database, clock, name=" ada ")

    enter(database, clock, "Ada")
    with pytest.raises(InputError, match="no researcher 'Eve'"):
        reset_second_factor(database, clock, name="Eve")


def test_the_address_for_a_device_is_what_programs_read() -> None:
    secret = new_secret()

    read = pyotp.parse_uri(address_for_device(secret, researcher="Ada L.", study="gestures"))

    assert isinstance(read, pyotp.TOTP)
    assert (read.secret, read.name, read.issuer) == (secret, "Ada L.", "Motion Jury gestures")
