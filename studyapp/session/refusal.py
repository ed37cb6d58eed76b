"""What is refused to a participant, in words made for them."""

from __future__ import annotations

from studyapp.study.design.message import Message, Value


class RefusalError(Exception):
    """A request that changes nothing; what was stored before stays stored.

    Parameters
    ----------
    what : str
        What happened, as a sentence for the participant. A literal with places named ``{so}``, so
        that it can be translated.
    remedy : str
        What they can do, as a sentence, in the same way.
    **values : int, str, Message or tuple of them
        What stands in the places of both.
    """

    def __init__(self, what: str, remedy: str, /, **values: Value) -> None:
        self.messages = (Message(what, **values), Message(remedy, **values))
        super().__init__(f"{self.what} {self.remedy}")

    @property
    def what(self) -> str:
        """What happened, in English."""
        return str(self.messages[0])

    @property
    def remedy(self) -> str:
        """What they can do, in English."""
        return str(self.messages[1])


class UnknownAddressError(RefusalError):
    """There is no such study session."""


class NotTheirsError(RefusalError):
    """The trial is not one of this study session."""


class ConflictError(RefusalError):
    """The request does not fit where the study session stands."""


class StudyFullError(ConflictError):
    """No place is open."""


class CrowdedAddressError(StudyFullError):
    """As many newcomers have come from one network address as may."""


class UnprovenError(RefusalError):
    """Nothing shows that this is the person who has the study session."""


class IneligibleError(RefusalError):
    """The study does not look for this person."""


class UninvitedError(RefusalError):
    """Nobody sent this person here by a name, and the study takes nobody else."""


class UnacceptableError(RefusalError):
    """An answer is missing or out of range, or the video is not yet watched."""


class TooMuchWatchedError(UnacceptableError):
    """More was reported as played than can have been."""
