"""A researcher's account, as the rest of the house sees it: without the password."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import cast

from studyapp.database.tables import Researcher
from studyapp.researchers.roles import RIGHTS, Right, Role


@dataclass(frozen=True, kw_only=True)
class Account:
    """Who a researcher is; see `studyapp.database.tables.Researcher`."""

    id: int
    name: str
    role: Role
    joined_at: datetime
    disabled_at: datetime | None
    has_second_factor: bool

    def may(self, right: Right) -> bool:
        """Tell whether this researcher has `right`."""
        return self.disabled_at is None and right in RIGHTS[self.role]


def account_of(row: Researcher) -> Account:
    """Return the account that `row` stores."""
    return Account(
        id=row.id,
        name=row.name,
        role=cast(Role, row.role),
        joined_at=row.joined_at,
        disabled_at=row.disabled_at,
        has_second_factor=row.totp_secret is not None,
    )
