"""By which pseudonyms researchers' pages call participants: those of the study's exports."""

from __future__ import annotations

from dataclasses import dataclass

from motion.errors import InputError
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.researchers.roles import Right
from studyapp.study.folder import StudyFolder
from studyapp.web.research.visitor import researcher
from studyapp.web.running import running


@dataclass(frozen=True, kw_only=True)
class Naming:
    """How a page may call participants.

    Attributes
    ----------
    key : PseudonymKey or None
    reason : str
        Why there are no pseudonyms, as a sentence; empty where there are, and where who asks may
        not see answers of single participants in any case.
    """

    key: PseudonymKey | None
    reason: str = ""


def naming() -> Naming:
    """Return how the page that is asked for may call participants; it draws no key."""
    if not researcher().may(Right.READ):
        return Naming(key=None)
    try:
        key = PseudonymKey.read(StudyFolder(running().folder).pseudonym_key)
    except InputError as error:
        return Naming(key=None, reason=f"Pseudonyms cannot be shown: {error.what}.")
    except OSError:
        return Naming(key=None, reason="Pseudonyms cannot be shown: the server may not read them.")
    return Naming(key=key, reason="" if key else "Pseudonyms are drawn at the first export.")
