"""What is refused to a participant, in words made for them."""

from __future__ import annotations


class RefusalError(Exception):
    """A request that changes nothing; what was stored before stays stored.

    Parameters
    ----------
    what : str
        What happened, as a sentence for the participant.
    remedy : str
        What they can do, as a sentence.
    """

    def __init__(self, what: str, remedy: str) -> None:
        self.what = what
        self.remedy = remedy
        super().__init__(f"{what} {remedy}")


class UnknownAddressError(RefusalError):
    """There is no such study session."""


class NotTheirsError(RefusalError):
    """The trial is not one of this study session."""


class ConflictError(RefusalError):
    """The request does not fit where the study session stands."""


class StudyFullError(ConflictError):
    """No place is open."""


class IneligibleError(RefusalError):
    """The study does not look for this person."""


class UnacceptableError(RefusalError):
    """An answer is missing or out of range, or the video is not yet watched."""
