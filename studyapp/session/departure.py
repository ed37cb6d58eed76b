"""How a participant gets back to where they came from, once the end is stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final
from urllib.parse import urlencode

from studyapp.database.tables import StudySession
from studyapp.study.settings.recruitment import Channel, Outcome, Recruitment

PROLIFIC_SITE: Final = "https://app.prolific.com"
PROLIFIC_END: Final = f"{PROLIFIC_SITE}/submissions/complete"

MTURK_SITES: Final = ("https://www.mturk.com", "https://workersandbox.mturk.com")
"""Where the end of an assignment may be reported to; nowhere else."""

MTURK_FRAMES: Final = ("https://worker.mturk.com", *MTURK_SITES)
"""Whose pages show a study in a frame of theirs."""

MTURK_END: Final = "/mturk/externalSubmit"


@dataclass(frozen=True, kw_only=True)
class Leaving:
    """What the last page offers.

    Attributes
    ----------
    channel : Channel
        What the page can say of the place they came from.
    outcome : Outcome or None
        How the study session ended; None of somebody who was screened out.
    code : str
        The completion code.
    address : str
        The link back, or where a form goes; empty where there is neither.
    assignment : str
        What a form sends along; empty where a link leads back.
    """

    channel: Channel
    outcome: Outcome | None
    code: str
    address: str = ""
    assignment: str = ""


def leaving(recruitment: Recruitment, study_session: StudySession) -> Leaving | None:
    """Return how the participant of `study_session` leaves; None before the end is stored."""
    own = study_session.completion_code
    if own is None:
        return None
    failed = study_session.outcome == "failed_attention"
    outcome: Outcome = "failed_attention" if failed else "completed"
    # Who came while the study was open to everybody has no place at a recruiter's site.
    if study_session.recruiter_participant is not None:
        if recruitment.channel == "prolific":
            code = recruitment.prolific.code(outcome)
            return Leaving(
                channel="prolific", outcome=outcome, code=code, address=prolific_end(code)
            )
        if recruitment.channel == "mturk" and study_session.submit_to in MTURK_SITES:
            return Leaving(
                channel="mturk",
                outcome=outcome,
                code=own,
                address=study_session.submit_to + MTURK_END,
                assignment=study_session.recruiter_session,
            )
    channel: Channel = "invitations" if recruitment.channel == "invitations" else "link"
    return Leaving(channel=channel, outcome=outcome, code=own)


def leaving_at_once(recruitment: Recruitment) -> Leaving:
    """Return how somebody leaves who was screened out, which must be stored before."""
    if recruitment.channel != "prolific":
        return Leaving(channel=recruitment.channel, outcome=None, code="")
    code = recruitment.prolific.screened_out
    return Leaving(channel="prolific", outcome=None, code=code, address=prolific_end(code))


def way_back(recruitment: Recruitment) -> str:
    """Return the address of where somebody came from who gets no code; empty if there is none.

    They return their place there. A code would pay them, and nothing of them is stored.
    """
    return PROLIFIC_SITE if recruitment.channel == "prolific" else ""


def prolific_end(code: str) -> str:
    """Return the address that tells Prolific of `code`."""
    return f"{PROLIFIC_END}?{urlencode({'cc': code})}"
