"""Accounts on both databases: roles and links, also when several people use them at once."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import pytest

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.researchers.account import change_role, list_accounts, set_access
from studyapp.researchers.audit import event_label, latest_changes
from studyapp.researchers.credentials import MAX_ATTEMPTS_PER_NAME, TooManyAttemptsError
from studyapp.researchers.links import (
    LIFETIME,
    UnusableLinkError,
    find_link,
    first_owner_link,
    invite,
    join,
    list_usable_links,
    revoke_link,
)
from studyapp.researchers.logins import WrongLoginError
from tests.studyapp.researchers.conftest import NEW, Door
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.taking_part_steps import SetClock

Given = TypeVar("Given")


def test_the_last_owner_can_neither_leave_nor_change_role(door: Door) -> None:
    charles = door.join("Charles", "analyst")

    with pytest.raises(InputError, match=r"only owner.*somebody else"):
        set_access(door.database, door.clock, door.ada, allowed=False, by="Ada")
    with pytest.raises(InputError, match="only owner"):
        change_role(door.database, door.clock, door.ada, "viewer", by="Ada")
    change_role(door.database, door.clock, charles, "owner", by="Ada")
    set_access(door.database, door.clock, door.ada, allowed=False, by="Charles")
    with pytest.raises(InputError, match="only owner"):
        set_access(door.database, door.clock, charles, allowed=False, by="Charles")


def test_changing_access_or_role_logs_a_researcher_out_at_once(door: Door) -> None:
    number = door.join("Charles")
    login = door.enter("Charles")
    set_access(door.database, door.clock, number, allowed=False, by="Ada")
    assert door.who(login) is None
    door.turns_away("Charles")
    set_access(door.database, door.clock, number, allowed=True, by="Ada")
    assert door.who(login) is None
    login = door.enter("Charles")

    change_role(door.database, door.clock, number, "analyst", by="Ada")

    assert door.who(login) is None
    again = door.who(door.enter("Charles"))
    assert again is not None and again.role == "analyst"
    lines = latest_changes(door.database)[1:6:2]
    assert [(event_label(line), line.researcher, line.detail) for line in lines] == [
        ("role changed", "Ada", "Charles: viewer becomes analyst"),
        ("access restored", "Ada", "Charles"),
        ("logged in", "Charles", ""),
    ]


def test_a_link_for_the_first_owner_ends_with_a_newer_one_and_with_any_owner(
    database: Database, clock: SetClock
) -> None:
    older, newer = (first_owner_link(database, clock) or "" for _ in range(2))

    with pytest.raises(UnusableLinkError):
        find_link(database, older, clock.now())
    assert find_link(database, newer, clock.now()).role == "owner"

    invitation = invite(database, clock, role="owner", by="")
    join(database, clock, invitation, name="Ada", password=PASSWORD)
    with pytest.raises(UnusableLinkError):
        find_link(database, newer, clock.now())


@pytest.mark.parametrize("purpose", ["invitation", "new_password"])
def test_a_link_expires(door: Door, purpose: str) -> None:
    token = door.invite() if purpose == "invitation" else door.offer("ada")
    door.clock.advance(seconds=LIFETIME[purpose].total_seconds() - 1)
    assert door.purpose(token) == purpose

    door.clock.advance(seconds=1)

    for use in (door.purpose, door.choose, door.use):
        with pytest.raises(UnusableLinkError):
            use(token)
    assert list_usable_links(door.database, door.clock.now()) == []


def test_names_are_unique_and_a_refused_name_leaves_the_link_usable(door: Door) -> None:
    token = door.invite("analyst")

    for name, problem in (("ADA", "already"), ("A", "2 to 100"), ("A\x00da", "visible")):
        with pytest.raises(InputError, match=problem):
            door.use(token, name)
    door.use(token, "Ada Byron")


def test_a_link_for_a_new_password_replaces_it_and_ends_all_logins(door: Door) -> None:
    elsewhere, older, token = door.enter(), door.offer(), door.offer("ADA")
    for use, link in ((door.purpose, older), (door.use, token)):
        with pytest.raises(UnusableLinkError):
            use(link)

    login = door.choose(token)

    assert door.who(elsewhere) is None
    assert door.who(login or "") is not None
    door.enter(password=NEW)


def test_removed_researchers_get_no_new_password(door: Door) -> None:
    out = door.join("Charles", "analyst")
    before = door.offer("Charles")
    set_access(door.database, door.clock, out, allowed=False, by="Ada")

    with pytest.raises(InputError, match="no access"):
        door.offer("Charles")
    with pytest.raises(UnusableLinkError):
        door.choose(before)
    with pytest.raises(InputError, match=r"no researcher 'Nobody'.*list"):
        door.offer("Nobody")


def test_a_revoked_link_cannot_be_used(door: Door) -> None:
    token = door.invite("owner")
    (link,) = list_usable_links(door.database, door.clock.now())

    for _ in range(2):
        revoke_link(door.database, door.clock, link.id, by="Ada")

    with pytest.raises(UnusableLinkError):
        door.purpose(token)
    lines = [(line.researcher, event_label(line)) for line in latest_changes(door.database)]
    assert lines[:2] == [("Ada", "link taken back"), ("Ada", "invited")]


def at_once(do: Callable[[Given], object], each: Sequence[Given]) -> list[type[BaseException]]:
    """Do something several times side by side; return what was raised."""
    with ThreadPoolExecutor(6) as pool:
        done = [pool.submit(do, given) for given in each]
    return [type(error) for error in (one.exception() for one in done) if error is not None]


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

    raised = at_once(
        lambda one: set_access(door.database, door.clock, one, allowed=False, by=""), owners
    )

    assert raised == [InputError]
    assert sum(account.disabled_at is None for account in list_accounts(door.database)) == 1
