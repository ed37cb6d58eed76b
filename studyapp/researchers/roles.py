"""What each role may do: one table, which the pages ask and nothing else decides."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Final, Literal, get_args

Role = Literal["owner", "analyst", "viewer"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)


class Right(Enum):
    """Something that a researcher may do; the value says it in words."""

    KEEP_ACCOUNT = "change their own password, and log out"
    WATCH = "see how the study goes, what happened in each study session, and previews of trials"
    READ = "read what participants said about themselves, and the log of changes"
    STEER = "pause, resume, extend and close the study, and exclude participants from the analysis"
    UNBLIND = "look at results before the end, which is logged"
    NAME = "see by which name a recruiter knows a participant"
    MANAGE = "invite researchers, change their roles, and shut them out"


RIGHTS: Final[Mapping[Role, frozenset[Right]]] = {
    "viewer": frozenset({Right.KEEP_ACCOUNT, Right.WATCH}),
    "analyst": frozenset({Right.KEEP_ACCOUNT, Right.WATCH, Right.READ, Right.STEER, Right.UNBLIND}),
    "owner": frozenset(Right),
}
