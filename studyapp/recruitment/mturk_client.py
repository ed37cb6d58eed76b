"""Mechanical Turk's API, as far as a study needs it; in the sandbox, unless told otherwise.

boto3 finds the keys in the environment or in its own files; they never pass through here.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Final

from motion.errors import InputError
from studyapp.boto_errors import said_plainly

SANDBOX: Final = "https://mturk-requester-sandbox.us-east-1.amazonaws.com"
LIVE: Final = "https://mturk-requester.us-east-1.amazonaws.com"
REGION: Final = "us-east-1"
PAGE_SIZE: Final = 100
LONG_AGO: Final = datetime(2015, 1, 1, tzinfo=UTC)


@dataclass(frozen=True, kw_only=True)
class Hit:
    """A HIT and how far it is.

    Attributes
    ----------
    wanted, pending, available, completed : int
        Assignments in all, being worked on, not taken yet, and reviewed.
    """

    id: str
    status: str
    wanted: int
    pending: int
    available: int
    completed: int


@dataclass(frozen=True, kw_only=True)
class Assignment:
    """What one worker handed in."""

    id: str
    worker: str
    status: str
    answer: str


class MTurkClient:
    """A requester's access to Mechanical Turk.

    Parameters
    ----------
    connection : object
        boto3's client; see `connect`.
    """

    def __init__(self, connection: Any) -> None:
        self._connection = connection

    def create(self, request: Mapping[str, Any]) -> Hit:
        """Make a HIT; workers see it at once. The same request within a day makes no other one."""
        with _said_plainly("create a HIT"):
            return _hit(self._connection.create_hit(**request)["HIT"])

    def hit(self, hit: str) -> Hit:
        """Return the HIT with this id."""
        with _said_plainly(f"look at HIT {hit}"):
            return _hit(self._connection.get_hit(HITId=hit)["HIT"])

    def stop(self, hit: str) -> None:
        """Offer a HIT to nobody any more; who works on it may finish."""
        with _said_plainly(f"stop HIT {hit}"):
            self._connection.update_expiration_for_hit(HITId=hit, ExpireAt=LONG_AGO)

    def assignments(self, hit: str) -> list[Assignment]:
        """Return everything that was handed in for a HIT."""
        with _said_plainly(f"list the assignments of HIT {hit}"):
            pages = self._connection.get_paginator("list_assignments_for_hit")
            return [
                Assignment(
                    id=found["AssignmentId"],
                    worker=found["WorkerId"],
                    status=found["AssignmentStatus"],
                    answer=found.get("Answer", ""),
                )
                for page in pages.paginate(HITId=hit, PaginationConfig={"PageSize": PAGE_SIZE})
                for found in page["Assignments"]
            ]

    def approve(self, assignment: str) -> None:
        """Pay for an assignment."""
        with _said_plainly(f"approve assignment {assignment}"):
            self._connection.approve_assignment(AssignmentId=assignment)


def connect(*, live: bool) -> MTurkClient:
    """Return access to Mechanical Turk, or to its sandbox.

    Raises
    ------
    InputError
        If boto3 is not installed.
    """
    try:
        import boto3
    except ImportError:
        raise InputError(
            "Mechanical Turk needs boto3, which is not installed",
            remedy="Install it with 'pip install motionjury[mturk]'",
        ) from None
    endpoint = LIVE if live else SANDBOX
    return MTurkClient(boto3.client("mturk", region_name=REGION, endpoint_url=endpoint))


def _said_plainly(what: str) -> AbstractContextManager[None]:
    return said_plainly(
        "Mechanical Turk",
        what,
        correct="Correct what it names; requesters of the sandbox and of the live site are "
        "different accounts",
        check="the network",
    )


def _hit(found: Mapping[str, Any]) -> Hit:
    return Hit(
        id=found["HITId"],
        status=found.get("HITStatus", ""),
        wanted=found.get("MaxAssignments", 0),
        pending=found.get("NumberOfAssignmentsPending", 0),
        available=found.get("NumberOfAssignmentsAvailable", 0),
        completed=found.get("NumberOfAssignmentsCompleted", 0),
    )
