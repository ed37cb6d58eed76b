from __future__ import annotations

import pytest

from studyapp.database.engine import Database
from studyapp.researchers.account import Account
from studyapp.researchers.logins import IDLE, LONGEST, end_login, logged_in
from tests.studyapp.researchers_at_hand import enter, joined
from tests.studyapp.taking_part_steps import SetClock

pytestmark = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)


def who(database: Database, clock: SetClock, login: str, *, by_hand: bool = True) -> Account | None:
    return logged_in(database, login, clock.now(), by_hand=by_hand)


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


def test_logging_out_ends_one_login_and_no_other(database: Database, clock: SetClock) -> None:
    joined(database, clock, "Ada")
    one, other = enter(database, clock, "Ada"), enter(database, clock, "Ada")
    assert one != other

    end_login(database, one)

    assert who(database, clock, one) is None
    assert who(database, clock, other) is not None
    assert who(database, clock, "") is None
