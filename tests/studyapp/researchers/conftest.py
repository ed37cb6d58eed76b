"""What the tests of researchers' accounts share."""

from dataclasses import dataclass

import pytest

from studyapp.database.engine import Database
from studyapp.researchers.account import Account, Role
from studyapp.researchers.links import choose_password, find_link, invite, join, offer_new_password
from studyapp.researchers.logins import WrongLoginError, find_account_by_login, log_in
from tests.support.researcher_accounts import HERE, PASSWORD, joined
from tests.support.studies.taking_part_steps import SetClock

NEW = "seven quiet bicycles"


@dataclass(frozen=True)
class Door:
    """The accounts of a study, whose first owner is Ada, on a clock that the test moves."""

    database: Database
    clock: SetClock
    ada: int

    def join(self, name: str, role: Role = "viewer") -> int:
        return joined(self.database, self.clock, name, role)

    def enter(
        self, name: str = "Ada", password: str = PASSWORD, *, code: str = "", address: str = HERE
    ) -> str:
        given = {"name": name, "password": password, "code": code}
        return log_in(self.database, self.clock, **given, address=address)

    def turns_away(self, name: str = "Ada", password: str = PASSWORD, *, code: str = "") -> str:
        """Return the message of a refusal."""
        with pytest.raises(WrongLoginError) as refused:
            self.enter(name, password, code=code)
        return str(refused.value)

    def who(self, login: str, *, by_hand: bool = True) -> Account | None:
        return find_account_by_login(self.database, login, self.clock.now(), by_hand=by_hand)

    def invite(self, role: Role = "viewer") -> str:
        return invite(self.database, self.clock, role=role, by="Ada")

    def use(self, token: str, name: str = "Eve", password: str = PASSWORD) -> str:
        return join(self.database, self.clock, token, name=name, password=password)

    def offer(self, name: str = "Ada") -> str:
        return offer_new_password(self.database, self.clock, name=name, by="Ada")

    def choose(self, token: str) -> str | None:
        return choose_password(self.database, self.clock, token, password=NEW)

    def purpose(self, token: str) -> str:
        return find_link(self.database, token, self.clock.now()).purpose


@pytest.fixture
def door(database: Database, clock: SetClock) -> Door:
    return Door(database, clock, joined(database, clock, "Ada"))
