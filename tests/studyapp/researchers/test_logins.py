from contextlib import suppress
from datetime import timedelta
from typing import NamedTuple

import pyotp
import pytest
from argon2 import PasswordHasher
from sqlalchemy import func, select

from motion.errors import InputError
from studyapp.database.tables.researchers import (
    LoginAttempt,
    Researcher,
    ResearcherLink,
    ResearcherLogin,
)
from studyapp.researchers import credentials
from studyapp.researchers.account import set_access
from studyapp.researchers.credentials import (
    MAX_ATTEMPTS_PER_ADDRESS,
    MAX_ATTEMPTS_PER_NAME,
    MAX_PASSWORD_LENGTH,
    WINDOW,
    TooManyAttemptsError,
    check_password,
    enable_second_factor,
    hash_password,
    new_secret,
    verify_password,
)
from studyapp.researchers.logins import MAX_DURATION, MAX_IDLE, WrongLoginError, change_password
from tests.studyapp.researchers.conftest import NEW, Door
from tests.support.researcher_accounts import HERE, PASSWORD

ELSEWHERE = "192.0.2.9"


@pytest.mark.parametrize(
    ("by_hand", "step", "lasts"),
    [
        (True, MAX_IDLE.total_seconds(), 0),
        (True, MAX_IDLE.total_seconds() - 1, int(MAX_DURATION / MAX_IDLE)),
        (False, MAX_IDLE.total_seconds() / 3, 2),
    ],
    ids=["idle", "for ever", "a page that refreshes itself"],
)
def test_logins_end_when_idle_and_after_a_maximum(
    door: Door, *, by_hand: bool, step: float, lasts: int
) -> None:
    login = door.enter()
    for _ in range(lasts):
        door.clock.advance(seconds=step)
        assert door.who(login, by_hand=by_hand) is not None
    door.clock.advance(seconds=step)

    assert door.who(login, by_hand=by_hand) is None


def test_every_refusal_has_the_same_message_and_cost(
    door: Door, monkeypatch: pytest.MonkeyPatch
) -> None:
    set_access(door.database, door.clock, door.join("Charles"), allowed=False, by="Ada")
    verified: list[str] = []

    def verify(hasher: PasswordHasher, password_hash: str, password: str) -> bool:
        verified.append(password_hash[: password_hash.index("p=1")])
        return hash_and_compare(hasher, password_hash, password)

    hash_and_compare = PasswordHasher.verify
    monkeypatch.setattr(PasswordHasher, "verify", verify)
    tried = [("Ada", "wrong"), ("Nobody", PASSWORD), ("Charles", PASSWORD), ("\x00", "")]

    assert len({door.turns_away(*each) for each in tried}) == 1
    assert verified == ["$argon2id$v=19$m=8,t=1,"] * 4


def test_a_password_is_rehashed_when_the_parameters_change(
    door: Door, monkeypatch: pytest.MonkeyPatch
) -> None:
    dearer = PasswordHasher(time_cost=2, memory_cost=8, parallelism=1)
    monkeypatch.setattr(credentials, "HASHER", dearer)

    door.enter()

    with door.database.reading() as session:
        assert ",t=2," in session.scalars(select(Researcher.password_hash)).one()
    door.enter()


def test_too_many_attempts_block_even_the_right_password_for_a_while(door: Door) -> None:
    for _ in range(MAX_ATTEMPTS_PER_NAME):
        door.clock.advance(seconds=1)
        door.turns_away("ada", "wrong")

    with pytest.raises(TooManyAttemptsError, match="15 minutes") as caught:
        door.enter()
    door.clock.advance(seconds=caught.value.seconds - 1)
    with pytest.raises(TooManyAttemptsError):
        door.enter()
    door.enter(address=ELSEWHERE)
    # A clock that was set back does not extend the lockout.
    door.clock.advance(hours=-1)
    door.enter()
    door.clock.advance(hours=1, seconds=1)
    door.enter()


def test_one_address_cannot_try_many_names(door: Door) -> None:
    for number in range(MAX_ATTEMPTS_PER_ADDRESS):
        door.turns_away(f"name {number}", "wrong")

    with pytest.raises(TooManyAttemptsError):
        door.enter()
    door.enter(address=ELSEWHERE)


def test_the_right_password_clears_failed_attempts(door: Door) -> None:
    for _ in range(2):
        for _ in range(MAX_ATTEMPTS_PER_NAME - 1):
            door.turns_away(password="wrong")  # noqa: S106
        door.enter()
    door.turns_away("Other")
    door.clock.advance(seconds=WINDOW.total_seconds())
    door.turns_away("Other")

    with door.database.reading() as session:
        assert session.scalar(select(func.count()).select_from(LoginAttempt)) == 1


def test_guessing_the_old_password_is_counted_like_logging_in(door: Door) -> None:
    def change(old: str) -> None:
        given = {"old": old, "new": "x", "address": HERE}
        change_password(door.database, door.clock, researcher_id=door.ada, **given)

    for _ in range(MAX_ATTEMPTS_PER_NAME):
        with suppress(InputError):
            change("wrong")

    with pytest.raises(TooManyAttemptsError):
        change(PASSWORD)


def test_the_database_contains_no_password_cookie_or_link(door: Door) -> None:
    secrets = {door.enter(), door.invite()}

    with door.database.reading() as session:
        kept = (ResearcherLogin.token_hash, ResearcherLink.token_hash, Researcher.password_hash)
        stored = [text for column in kept for text in session.scalars(select(column))]
    assert len(stored) == 4
    assert not secrets & set(stored)
    assert PASSWORD not in "".join(stored)


GOOD = (
    *("correct horse battery", "tr0ub4dor&3xyz", "83920174650192837465"),
    *("password and purple rain", "日本語のとても長い合言葉です"),
)
COMMON = (
    *("password1234", "qwertyuiop12", "welcome-to-study", "MotionJury2026!"),
    *("secret shadow master", "a1" * 128, "Ada Lovelace 1815", "lovelace.ada.lovelace"),
)


def test_common_too_short_and_too_long_passwords_are_refused() -> None:
    for password in GOOD:
        check_password(password, name="Ada Lovelace")
    for password in COMMON:
        with pytest.raises(InputError, match=r"first that anybody would try.*words"):
            check_password(password, name="Ada Lovelace")
    for length in (0, 11, MAX_PASSWORD_LENGTH + 1):
        with pytest.raises(InputError, match=rf"12 to 256 characters, this one has {length}"):
            check_password(("zq7!kvmw2p#" * 50)[:length], name="Ada Lovelace")


def test_passwords_are_compared_after_unicode_normalisation() -> None:
    assert verify_password(hash_password("gru\u0308ne Wiesen im Mai"), "gr\u00fcne Wiesen im Mai")


class Device(NamedTuple):
    """What Ada has of her second factor."""

    door: Door
    secret: str
    recovery: list[str]

    def code(self, seconds: float = 0) -> str:
        return code_of(self.door, self.secret, seconds)


def code_of(door: Door, secret: str, seconds: float = 0) -> str:
    return pyotp.TOTP(secret).at(door.clock.now() + timedelta(seconds=seconds))


@pytest.fixture
def device(door: Door) -> Device:
    secret = new_secret()
    given = {"secret": secret, "code": code_of(door, secret), "password": PASSWORD}
    recovery = enable_second_factor(door.database, door.clock, door.ada, **given, address=HERE)
    door.clock.advance(seconds=30)
    return Device(door, secret, recovery)


def test_each_totp_code_logs_in_once(door: Door, device: Device) -> None:
    code = device.code()
    for wrong in ("", "000000", device.code(60)):
        door.turns_away(code=wrong)

    assert door.enter(code=f"{code[:3]} {code[3:]}")

    door.turns_away(code=code)
    # The device's clock may be off by half a minute.
    assert door.enter(code=device.code(30))


def test_a_recovery_code_logs_in_once_and_none_is_stored(door: Door, device: Device) -> None:
    first, second, *_ = device.recovery

    assert door.enter(code=first.upper())

    door.turns_away(code=first)
    assert door.enter(code=second.replace("-", " "))
    with door.database.reading() as session:
        kept = session.scalars(select(Researcher.recovery_hashes)).one()
    assert len(kept) == len(device.recovery) - 2
    assert not set(kept) & set(device.recovery)


def test_guesses_of_codes_are_limited(door: Door, device: Device) -> None:
    for number in range(MAX_ATTEMPTS_PER_NAME):
        with suppress(WrongLoginError):
            door.enter(code=f"{number:06}")

    with pytest.raises(TooManyAttemptsError):
        door.enter(code=device.code())


def test_a_password_link_does_not_bypass_the_second_factor(door: Door, device: Device) -> None:
    assert door.choose(door.offer()) is None

    door.turns_away(password=NEW)
    assert door.enter(password=NEW, code=device.code())
