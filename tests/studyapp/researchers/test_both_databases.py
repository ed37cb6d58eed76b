"""What databases may do differently: several at once, and every kind of statement once."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.researchers.account import accounts, let_in_again, shut_out
from studyapp.researchers.attempts import MOST_OF_NAME, TooManyAttemptsError
from studyapp.researchers.links import (
    UnusableLinkError,
    choose_password,
    invite,
    join,
    offer_new_password,
)
from studyapp.researchers.logins import WrongLoginError, logged_in
from tests.studyapp.researchers_at_hand import PASSWORD, enter, joined
from tests.studyapp.taking_part_steps import SetClock


def test_an_account_lives_from_the_link_to_the_end(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    number = joined(database, clock, "Charles", "viewer")
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Charles", "wrong")
    login = enter(database, clock, "Charles")
    clock.advance(minutes=2)
    assert logged_in(database, login, clock.now(), by_hand=True) is not None
    token = offer_new_password(database, clock, name="Charles", by="Ada")
    choose_password(database, clock, token, password="seven quiet bicycles")  # noqa: S106
    assert logged_in(database, login, clock.now(), by_hand=True) is None
    shut_out(database, clock, number, by="Ada")
    let_in_again(database, clock, number, by="Ada")

    enter(database, clock, "Charles", "seven quiet bicycles")

    assert [account.disabled_at for account in accounts(database)] == [None, None]
    with pytest.raises(InputError, match="already"):
        join(
            database,
            clock,
            invite(database, clock, role="viewer", by=""),
            name="ada",
            password=PASSWORD,
        )


def test_attempts_at_the_same_moment_get_no_further(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")

    def attempt(_: int) -> bool:
        try:
            enter(database, clock, "Ada", "wrong")
        except TooManyAttemptsError:
            return False
        except WrongLoginError:
            return True
        raise AssertionError

    with ThreadPoolExecutor(6) as pool:
        compared = list(pool.map(attempt, range(MOST_OF_NAME + 6)))

    assert sum(compared) == MOST_OF_NAME


def test_a_link_used_by_two_at_once_makes_one_account(database: Database, clock: SetClock) -> None:
    token = invite(database, clock, role="viewer", by="")

    def use(name: str) -> bool:
        try:
            join(database, clock, token, name=name, password=PASSWORD)
        except UnusableLinkError:
            return False
        return True

    with ThreadPoolExecutor(4) as pool:
        used = list(pool.map(use, ["Ada", "Charles", "Mary", "George"]))

    assert sum(used) == len(accounts(database)) == 1


def test_owners_who_shut_each_other_out_at_once_leave_one(
    database: Database, clock: SetClock
) -> None:
    owners = [joined(database, clock, name) for name in ("Ada", "Charles", "Mary")]

    def leave(number: int) -> None:
        try:
            shut_out(database, clock, number, by="")
        except InputError as error:
            assert "only owner" in str(error)

    with ThreadPoolExecutor(3) as pool:
        list(pool.map(leave, owners))

    assert sum(account.disabled_at is None for account in accounts(database)) == 1
