from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.researchers.account import (
    change_role,
    let_in_again,
    shut_out,
)
from studyapp.researchers.audit import logged_changes
from studyapp.researchers.logins import WrongLoginError, logged_in
from tests.studyapp.researchers_at_hand import enter, joined
from tests.studyapp.taking_part_steps import SetClock

pytestmark = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)


def test_the_last_owner_can_neither_leave_nor_become_something_else(
    database: Database, clock: SetClock
) -> None:
    ada = joined(database, clock, "Ada")
    charles = joined(database, clock, "Charles", "analyst")

    with pytest.raises(InputError, match=r"only owner.*another|only owner.*somebody else"):
        shut_out(database, clock, ada, by="Ada")
    with pytest.raises(InputError, match="only owner"):
        change_role(database, clock, ada, "viewer", by="Ada")
    change_role(database, clock, charles, "owner", by="Ada")
    shut_out(database, clock, ada, by="Charles")
    with pytest.raises(InputError, match="only owner"):
        shut_out(database, clock, charles, by="Charles")


def test_who_is_shut_out_is_logged_out_at_once_and_can_be_let_in_again(
    database: Database, clock: SetClock
) -> None:
    joined(database, clock, "Ada")
    number = joined(database, clock, "Charles", "viewer")
    login = enter(database, clock, "Charles")

    shut_out(database, clock, number, by="Ada")

    assert logged_in(database, login, clock.now(), by_hand=True) is None
    with pytest.raises(WrongLoginError):
        enter(database, clock, "Charles")
    let_in_again(database, clock, number, by="Ada")
    assert logged_in(database, login, clock.now(), by_hand=True) is None
    enter(database, clock, "Charles")
    assert [line.event for line in logged_changes(database)][1:3] == [
        "access restored",
        "access removed",
    ]


def test_another_role_needs_another_login(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    number = joined(database, clock, "Charles", "viewer")
    login = enter(database, clock, "Charles")

    change_role(database, clock, number, "analyst", by="Ada")

    assert logged_in(database, login, clock.now(), by_hand=True) is None
    again = logged_in(database, enter(database, clock, "Charles"), clock.now(), by_hand=True)
    assert again is not None
    assert again.role == "analyst"
    newest = logged_changes(database)[1]
    assert (newest.researcher, newest.detail) == ("Ada", "Charles: viewer becomes analyst")
