from __future__ import annotations

from contextlib import suppress

import pytest
from argon2 import PasswordHasher
from sqlalchemy import func, select

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import LoginAttempt, Researcher, ResearcherLink, ResearcherLogin
from studyapp.researchers import credentials as passwords
from studyapp.researchers.account import Account, shut_out
from studyapp.researchers.attempts import (
    MOST_OF_ADDRESS,
    MOST_OF_NAME,
    WINDOW,
    TooManyAttemptsError,
)
from studyapp.researchers.links import invite
from studyapp.researchers.logins import (
    IDLE,
    LONGEST,
    WrongLoginError,
    change_password,
    logged_in,
)
from tests.studyapp.researchers_at_hand import HERE, PASSWORD, enter, joined
from tests.studyapp.taking_part_steps import SetClock

pytestmark = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)


def who(database: Database, clock: SetClock, login: str, *, by_hand: bool = True) -> Account | None:
    return logged_in(database, login, clock.now(), by_hand=by_hand)


def guess(database: Database, clock: SetClock, names: list[str], address: str = HERE) -> None:
    """Try a wrong password for each of `names`."""
    for name in names:
        with pytest.raises(WrongLoginError):
            enter(database, clock, name, "wrong", address=address)


def test_who_does_nothing_for_an_hour_is_logged_out(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    login = enter(database, clock, "Ada")

    clock.advance(seconds=IDLE.total_seconds() - 1)
    assert who(database, clock, login) is not None
    clock.advance(seconds=IDLE.total_seconds() - 1)
    assert who(database, clock, login) is not None
    clock.advance(seconds=IDLE.total_seconds())
    assert who(database, clock, login) is None


def test_a_page_that_refreshes_itself_keeps_nobody_logged_in(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    login = enter(database, clock, "Ada")

    for _ in range(3):
        assert who(database, clock, login, by_hand=False) is not None
        clock.advance(seconds=IDLE.total_seconds() / 3)

    assert who(database, clock, login, by_hand=False) is None


def test_nobody_stays_logged_in_for_ever(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    login = enter(database, clock, "Ada")
    steps = int(LONGEST.total_seconds() / 1800)

    for _ in range(steps - 1):
        clock.advance(seconds=1800)
        assert who(database, clock, login) is not None
    clock.advance(seconds=1800)

    assert who(database, clock, login) is None


def test_every_refusal_says_the_same_after_the_same_work(
    database: Database, clock: SetClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    joined(database, clock, "Ada")
    out = joined(database, clock, "Charles", "viewer")
    shut_out(database, clock, out, by="Ada")
    verified: list[str] = []
    real = passwords.HASHER

    class Counting(PasswordHasher):
        def verify(self, hash: str | bytes, password: str | bytes) -> bool:  # type: ignore[override]
            verified.append(str(hash).rpartition("$")[0].rpartition("$")[0])
            return real.verify(hash, password)

    counting = Counting(time_cost=1, memory_cost=8, parallelism=1)
    monkeypatch.setattr(passwords, "HASHER", counting)

    said = []
    for name, password in (
        ("Ada", "wrong"),
        ("Nobody", PASSWORD),
        ("Charles", PASSWORD),
        ("\x00", ""),
    ):
        with pytest.raises(WrongLoginError) as caught:
            enter(database, clock, name, password)
        said.append(str(caught.value))

    assert len(set(said)) == 1
    assert verified == ["$argon2id$v=19$m=8,t=1,p=1"] * 4


def test_a_password_is_hashed_anew_when_the_parameters_have_changed(
    database: Database, clock: SetClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    joined(database, clock, "Ada")
    dearer = PasswordHasher(time_cost=2, memory_cost=8, parallelism=1)
    monkeypatch.setattr(passwords, "HASHER", dearer)

    enter(database, clock, "Ada")

    with database.reading() as session:
        assert ",t=2," in session.scalars(select(Researcher.password_hash)).one()
    enter(database, clock, "Ada")


def test_after_too_many_attempts_not_even_the_right_password_helps_for_a_while(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    for _ in range(MOST_OF_NAME):
        clock.advance(seconds=1)
        with pytest.raises(WrongLoginError):
            enter(database, clock, "ada", "wrong")

    with pytest.raises(TooManyAttemptsError, match="15 minutes") as caught:
        enter(database, clock, "Ada")
    clock.advance(seconds=caught.value.seconds - 1)
    with pytest.raises(TooManyAttemptsError):
        enter(database, clock, "Ada")
    clock.advance(seconds=1)
    enter(database, clock, "Ada")


def test_after_the_clock_went_back_an_hour_nobody_is_locked_out_for_longer(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    guess(database, clock, ["ada"] * MOST_OF_NAME)
    clock.advance(hours=-1)

    enter(database, clock, "Ada")


def test_wrong_passwords_from_elsewhere_lock_nobody_out(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    guess(database, clock, ["ada"] * MOST_OF_NAME, address="192.0.2.9")

    enter(database, clock, "Ada")

    with pytest.raises(TooManyAttemptsError):
        enter(database, clock, "Ada", address="192.0.2.9")


def test_one_address_cannot_try_many_names(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    guess(database, clock, [f"name {number}" for number in range(MOST_OF_ADDRESS)])

    with pytest.raises(TooManyAttemptsError):
        enter(database, clock, "Ada")
    enter(database, clock, "Ada", address="192.0.2.9")


def test_the_right_password_forgives_wrong_ones_and_old_attempts_are_not_kept(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    for _ in range(2):
        for _ in range(MOST_OF_NAME - 1):
            with pytest.raises(WrongLoginError):
                enter(database, clock, "Ada", "wrong")
        enter(database, clock, "Ada")
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Other", "wrong")
    clock.advance(seconds=WINDOW.total_seconds())
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Ada", "wrong")

    with database.reading() as session:
        assert session.scalar(select(func.count()).select_from(LoginAttempt)) == 1


def test_guessing_the_old_password_is_counted_like_logging_in(
    database: Database, clock: SetClock
) -> None:
    number = joined(database, clock, "Ada")
    for _ in range(MOST_OF_NAME):
        with suppress(InputError):
            change_password(
                database, clock, researcher_id=number, old="wrong", new="x", address=HERE
            )

    with pytest.raises(TooManyAttemptsError):
        change_password(database, clock, researcher_id=number, old=PASSWORD, new="x", address=HERE)


def test_the_database_holds_neither_passwords_nor_what_cookies_and_links_hold(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    secrets = {enter(database, clock, "Ada"), invite(database, clock, role="viewer", by="Ada")}

    with database.reading() as session:
        stored = {
            *session.scalars(select(ResearcherLogin.token_hash)),
            *session.scalars(select(ResearcherLink.token_hash)),
        }
        password_hash = session.scalars(select(Researcher.password_hash)).one()
    assert not secrets & stored
    assert PASSWORD not in password_hash
