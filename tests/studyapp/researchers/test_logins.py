from __future__ import annotations

from contextlib import suppress

import pytest
from argon2 import PasswordHasher
from sqlalchemy import func, select

from motion.errors import InputError
from studyapp.database.tables import LoginAttempt, Researcher, ResearcherLink, ResearcherLogin
from studyapp.researchers import credentials
from studyapp.researchers.account import remove_access
from studyapp.researchers.credentials import (
    MAX_ATTEMPTS_PER_ADDRESS,
    MAX_ATTEMPTS_PER_NAME,
    WINDOW,
    TooManyAttemptsError,
)
from studyapp.researchers.logins import MAX_DURATION, MAX_IDLE, change_password
from tests.studyapp.researchers.conftest import Door
from tests.support.researchers_at_hand import HERE, PASSWORD

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
def test_nobody_stays_logged_in_who_does_nothing_or_for_ever(
    door: Door, *, by_hand: bool, step: float, lasts: int
) -> None:
    login = door.enter()
    for _ in range(lasts):
        door.clock.advance(seconds=step)
        assert door.who(login, by_hand=by_hand) is not None
    door.clock.advance(seconds=step)

    assert door.who(login, by_hand=by_hand) is None


def test_every_refusal_says_the_same_after_the_same_work(
    door: Door, monkeypatch: pytest.MonkeyPatch
) -> None:
    remove_access(door.database, door.clock, door.join("Charles"), by="Ada")
    verified: list[str] = []

    def verify(hasher: PasswordHasher, password_hash: str, password: str) -> bool:
        verified.append(password_hash[: password_hash.index("p=1")])
        return hash_and_compare(hasher, password_hash, password)

    hash_and_compare = PasswordHasher.verify
    monkeypatch.setattr(PasswordHasher, "verify", verify)
    tried = [("Ada", "wrong"), ("Nobody", PASSWORD), ("Charles", PASSWORD), ("\x00", "")]

    assert len({door.turns_away(*each) for each in tried}) == 1
    assert verified == ["$argon2id$v=19$m=8,t=1,"] * 4


def test_a_password_is_hashed_anew_when_the_parameters_have_changed(
    door: Door, monkeypatch: pytest.MonkeyPatch
) -> None:
    dearer = PasswordHasher(time_cost=2, memory_cost=8, parallelism=1)
    monkeypatch.setattr(credentials, "HASHER", dearer)

    door.enter()

    with door.database.reading() as session:
        assert ",t=2," in session.scalars(select(Researcher.password_hash)).one()
    door.enter()


def test_after_too_many_attempts_not_even_the_right_password_helps_for_a_while(door: Door) -> None:
    for _ in range(MAX_ATTEMPTS_PER_NAME):
        door.clock.advance(seconds=1)
        door.turns_away("ada", "wrong")

    with pytest.raises(TooManyAttemptsError, match="15 minutes") as caught:
        door.enter()
    door.clock.advance(seconds=caught.value.seconds - 1)
    with pytest.raises(TooManyAttemptsError):
        door.enter()
    door.enter(address=ELSEWHERE)
    # Nor does a clock that was set back lock anybody out for longer.
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


def test_the_right_password_forgives_wrong_ones_and_old_attempts_are_not_kept(door: Door) -> None:
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


def test_the_database_holds_neither_passwords_nor_what_cookies_and_links_hold(door: Door) -> None:
    secrets = {door.enter(), door.invite()}

    with door.database.reading() as session:
        kept = (ResearcherLogin.token_hash, ResearcherLink.token_hash, Researcher.password_hash)
        stored = [text for column in kept for text in session.scalars(select(column))]
    assert len(stored) == 4
    assert not secrets & set(stored)
    assert PASSWORD not in "".join(stored)
