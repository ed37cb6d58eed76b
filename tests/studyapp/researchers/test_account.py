from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.researchers.account import change_role, remove_access, restore_access
from studyapp.researchers.audit import latest_changes
from tests.studyapp.researchers.conftest import Door


def test_the_last_owner_can_neither_leave_nor_become_something_else(door: Door) -> None:
    charles = door.join("Charles", "analyst")

    with pytest.raises(InputError, match=r"only owner.*somebody else"):
        remove_access(door.database, door.clock, door.ada, by="Ada")
    with pytest.raises(InputError, match="only owner"):
        change_role(door.database, door.clock, door.ada, "viewer", by="Ada")
    change_role(door.database, door.clock, charles, "owner", by="Ada")
    remove_access(door.database, door.clock, door.ada, by="Charles")
    with pytest.raises(InputError, match="only owner"):
        remove_access(door.database, door.clock, charles, by="Charles")


def test_whose_access_or_role_changes_is_logged_out_at_once(door: Door) -> None:
    number = door.join("Charles")
    login = door.enter("Charles")
    remove_access(door.database, door.clock, number, by="Ada")
    assert door.who(login) is None
    door.turns_away("Charles")
    restore_access(door.database, door.clock, number, by="Ada")
    assert door.who(login) is None
    login = door.enter("Charles")

    change_role(door.database, door.clock, number, "analyst", by="Ada")

    assert door.who(login) is None
    again = door.who(door.enter("Charles"))
    assert again is not None and again.role == "analyst"
    lines = latest_changes(door.database)[1:6:2]
    assert [(line.event, line.researcher, line.detail) for line in lines] == [
        ("role changed", "Ada", "Charles: viewer becomes analyst"),
        ("access restored", "Ada", "Charles"),
        ("logged in", "Charles", ""),
    ]
