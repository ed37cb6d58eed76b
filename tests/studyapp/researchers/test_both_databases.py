"""What databases may do differently: several at once, and every kind of statement once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import pytest

from motion.errors import InputError
from studyapp.researchers.account import list_accounts, remove_access, restore_access
from studyapp.researchers.credentials import MAX_ATTEMPTS_PER_NAME, TooManyAttemptsError
from studyapp.researchers.links import UnusableLinkError
from studyapp.researchers.logins import WrongLoginError
from tests.studyapp.researchers.conftest import NEW, Door

Given = TypeVar("Given")


def at_once(do: Callable[[Given], object], each: Sequence[Given]) -> list[type[BaseException]]:
    """Do something several times side by side; return what was raised."""

    def tried(given: Given) -> type[BaseException] | None:
        try:
            do(given)
        except InputError as error:
            return type(error)
        return None

    with ThreadPoolExecutor(6) as pool:
        return [raised for raised in pool.map(tried, each) if raised is not None]


def test_an_accounts_life_from_link_to_removal(door: Door) -> None:
    number = door.join("Charles")
    door.turns_away("Charles", "wrong")
    login = door.enter("Charles")
    door.clock.advance(minutes=2)
    assert door.who(login) is not None
    door.choose(door.offer("Charles"))
    assert door.who(login) is None
    remove_access(door.database, door.clock, number, by="Ada")
    restore_access(door.database, door.clock, number, by="Ada")

    door.enter("Charles", NEW)

    assert [account.disabled_at for account in list_accounts(door.database)] == [None, None]
    with pytest.raises(InputError, match="already"):
        door.use(door.invite(), "ada")


def test_simultaneous_attempts_count_towards_the_limit(door: Door) -> None:
    raised = at_once(lambda _: door.enter(password="wrong"), range(MAX_ATTEMPTS_PER_NAME + 6))  # noqa: S106

    assert raised.count(WrongLoginError) == MAX_ATTEMPTS_PER_NAME
    assert raised.count(TooManyAttemptsError) == 6


def test_a_link_used_twice_at_once_makes_one_account(door: Door) -> None:
    token = door.invite()

    raised = at_once(lambda name: door.use(token, name), ["Bea", "Charles", "Mary", "George"])

    assert raised == [UnusableLinkError] * 3
    assert len(list_accounts(door.database)) == 2


def test_owners_who_remove_each_other_at_once_leave_one(door: Door) -> None:
    owners = [door.ada, *(door.join(name, "owner") for name in ("Charles", "Mary"))]

    raised = at_once(lambda one: remove_access(door.database, door.clock, one, by=""), owners)

    assert raised == [InputError]
    assert sum(account.disabled_at is None for account in list_accounts(door.database)) == 1
