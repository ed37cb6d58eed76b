from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.researchers.account import shut_out
from studyapp.researchers.audit import logged_changes
from studyapp.researchers.links import (
    LIFETIME,
    UnusableLinkError,
    choose_password,
    first_owner_link,
    invite,
    join,
    link_of,
    offer_new_password,
    take_back_link,
    usable_links,
)
from studyapp.researchers.logins import logged_in
from tests.studyapp.researchers_at_hand import PASSWORD, enter, joined
from tests.studyapp.taking_part_steps import SetClock

pytestmark = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)


def test_a_newer_link_for_the_first_owner_replaces_the_older(
    database: Database, clock: SetClock
) -> None:
    older, newer = first_owner_link(database, clock), first_owner_link(database, clock)
    assert older is not None
    assert newer is not None

    with pytest.raises(UnusableLinkError):
        link_of(database, older, clock.now())
    assert link_of(database, newer, clock.now()).role == "owner"


@pytest.mark.parametrize("purpose", ["invitation", "new_password"])
def test_a_link_expires(database: Database, clock: SetClock, purpose: str) -> None:
    joined(database, clock, "Ada")
    if purpose == "invitation":
        token = invite(database, clock, role="viewer", by="Ada")
    else:
        token = offer_new_password(database, clock, name="ada", by="")
    clock.advance(seconds=LIFETIME[purpose].total_seconds() - 1)
    assert link_of(database, token, clock.now()).purpose == purpose

    clock.advance(seconds=1)

    with pytest.raises(UnusableLinkError):
        link_of(database, token, clock.now())
    with pytest.raises(UnusableLinkError):
        choose_password(database, clock, token, password="seven quiet bicycles")  # noqa: S106
    with pytest.raises(UnusableLinkError):
        join(database, clock, token, name="Eve", password=PASSWORD)
    assert usable_links(database, clock.now()) == []


def test_a_name_is_given_once_and_a_refused_one_leaves_the_link_usable(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada Lovelace")
    token = invite(database, clock, role="analyst", by="Ada Lovelace")

    for name, problem in (("ADA  LOVELACE", "already"), ("A", "2 to 100"), ("A\x00da", "seen")):
        with pytest.raises(InputError, match=problem):
            join(database, clock, token, name=name, password=PASSWORD)
    join(database, clock, token, name="Ada Byron", password=PASSWORD)


def test_a_link_for_a_new_password_replaces_it_and_ends_all_logins(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    elsewhere = enter(database, clock, "Ada")
    older = offer_new_password(database, clock, name="Ada", by="")
    token = offer_new_password(database, clock, name="ADA", by="")
    with pytest.raises(UnusableLinkError):
        link_of(database, older, clock.now())
    with pytest.raises(UnusableLinkError):
        join(database, clock, token, name="Eve", password=PASSWORD)

    login = choose_password(database, clock, token, password="seven quiet bicycles")  # noqa: S106

    assert logged_in(database, elsewhere, clock.now(), by_hand=True) is None
    assert login is not None
    assert logged_in(database, login, clock.now(), by_hand=True) is not None
    enter(database, clock, "Ada", "seven quiet bicycles")


def test_who_is_shut_out_gets_no_new_password(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    out = joined(database, clock, "Charles", "analyst")
    before = offer_new_password(database, clock, name="Charles", by="")
    shut_out(database, clock, out, by="Ada")

    with pytest.raises(InputError, match="no access"):
        offer_new_password(database, clock, name="Charles", by="")
    with pytest.raises(UnusableLinkError):
        choose_password(database, clock, before, password=PASSWORD)
    with pytest.raises(InputError, match=r"no researcher 'Nobody'.*list"):
        offer_new_password(database, clock, name="Nobody", by="")


def test_a_link_that_was_taken_back_cannot_be_used(database: Database, clock: SetClock) -> None:
    token = invite(database, clock, role="owner", by="Ada")
    (link,) = usable_links(database, clock.now())

    take_back_link(database, clock, link.id, by="Ada")
    take_back_link(database, clock, link.id, by="Ada")

    with pytest.raises(UnusableLinkError):
        link_of(database, token, clock.now())
    assert [(line.researcher, line.event) for line in logged_changes(database)] == [
        ("Ada", "link taken back"),
        ("Ada", "invited"),
    ]
