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
from studyapp.researchers.credentials import (
    LONGEST,
    check_password,
    hashed,
    is_right,
    new_secret,
    turn_off,
    turn_on,
)
from studyapp.researchers.links import choose_password, offer_new_password
from studyapp.researchers.logins import WrongLoginError, log_in
from tests.studyapp.researchers_at_hand import HERE, PASSWORD, enter, joined
from tests.studyapp.taking_part_steps import SetClock


@pytest.mark.parametrize(
    "password",
    [
        "correct horse battery",
        "tr0ub4dor&3xyz",
        "83920174650192837465",
        "password and purple rain",
        "日本語のとても長い合言葉です",
    ],
)
def test_what_nobody_would_try_first_is_accepted(password: str) -> None:
    check_password(password, name="Ada Lovelace")


@pytest.mark.parametrize(
    "password",
    [
        "password1234",
        "qwertyuiop12",
        "welcome-to-study",
        "MotionJury2026!",
        "secret shadow master",
        "a1" * 128,
        "Ada Lovelace 1815",
        "lovelace.ada.lovelace",
    ],
)
def test_what_everybody_tries_first_is_refused(password: str) -> None:
    name = "Lovelace" if password.startswith("lovelace") else "Ada Lovelace"
    with pytest.raises(InputError, match=r"first that anybody would try.*words"):
        check_password(password, name=name)


@pytest.mark.parametrize("length", [0, 11, LONGEST + 1])
def test_a_password_of_another_length_is_refused_with_both_limits(length: int) -> None:
    with pytest.raises(InputError, match=rf"12 to 256 characters, this one has {length}"):
        check_password(("zq7!kvmw2p#" * 50)[:length], name="Ada")


def test_a_password_is_the_same_however_its_letters_are_encoded() -> None:
    assert is_right(hashed("gru\u0308ne Wiesen im Mai"), "gr\u00fcne Wiesen im Mai")


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
