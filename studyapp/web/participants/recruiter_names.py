"""By what participants are named in the address that brings them, channel by channel.

Where the researcher turns it on, Prolific adds a token (a JWT, RS256) to the study's address. It
says by what the participant is named, for which host, and until when. The keys are public. Nobody
else can make up who comes.

Who comes again by the same name shows by a cookie to have been here before. It holds the token of
their study session, as the addresses of their pages do, and goes to the entrance alone. Nothing
else needs it: a study in a frame of another site, or a browser without cookies, works without.
"""

from __future__ import annotations

import logging
import re
import threading
import time
from collections.abc import Mapping
from datetime import timedelta
from functools import cache, partial
from types import MappingProxyType
from typing import Any, Final
from urllib.parse import urlsplit

import jwt

from studyapp.recruitment.invitations import invited
from studyapp.researchers.credentials import token_hash
from studyapp.session.arrivals import Arrival
from studyapp.session.ending import MTURK_SITES
from studyapp.session.refusal import UnacceptableError, UninvitedError
from studyapp.study.settings.recruitment import Channel
from studyapp.web.site import TokenCookie, newcomers_address, study_site

SIGNED: Final = "prolific_token"
KEYS: Final = "https://api.prolific.com/.well-known/study/jwks.json"
KEYS_LAST: Final = 24 * 3600
ASKED_AGAIN: Final = 60.0
"""Seconds after which keys may be fetched anew for a token whose key is unknown."""

READING: Final = 3600
"""Seconds for which a token still counts after its end: its holder is reading the first pages."""

LONGEST: Final = 4096
LOG: Final = logging.getLogger(__name__)


class ProlificKeys:
    """The keys that Prolific signs with, kept for a day."""

    def __init__(self) -> None:
        self._client = jwt.PyJWKClient(KEYS, lifespan=KEYS_LAST, timeout=5)
        self._lock = threading.Lock()
        self._fetched = float("-inf")

    def find(self, kid: str) -> jwt.PyJWK | None:
        """Return the key of this name, None where Prolific has no such key."""
        with self._lock:
            found = self._named(kid, refresh=False)
            if found is None and time.monotonic() - self._fetched > ASKED_AGAIN:
                self._fetched = time.monotonic()
                found = self._named(kid, refresh=True)
        return found

    def _named(self, kid: str, *, refresh: bool) -> jwt.PyJWK | None:
        keys = self._client.get_jwk_set(refresh=refresh).keys
        return next((key for key in keys if key.key_id == kid), None)


@cache
def prolific_keys() -> ProlificKeys:
    """Return the keys that Prolific signs with."""
    return ProlificKeys()


def signed_names(token: str, host: str) -> dict[str, str] | None:
    """Return by what Prolific names the holder of `token`, None where Prolific did not sign it.

    Parameters
    ----------
    host : str
        Whom the token must be made for.

    Raises
    ------
    UnacceptableError
        If the keys cannot be fetched.
    """
    if not token or len(token) > LONGEST:
        return None
    try:
        kid = str(jwt.get_unverified_header(token).get("kid"))
        key = prolific_keys().find(kid)
        if key is None:
            return None
        claims = jwt.decode(
            token,
            key,
            algorithms=["RS256"],
            leeway=READING,
            options={"require": ["exp", "aud"], "verify_aud": False},
        )
    except jwt.PyJWKClientError:
        LOG.warning("The keys that Prolific signs with could not be fetched")
        raise UnacceptableError(
            "At the moment we cannot verify that Prolific sent you.",
            "Please open the study from Prolific again in a few minutes.",
        ) from None
    except jwt.InvalidTokenError:
        return None
    named = claims.get("prolific")
    if not _is_for(claims["aud"], host) or not isinstance(named, dict):
        return None
    names = {name: named.get(name) for name in ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")}
    whole = {name: value for name, value in names.items() if isinstance(value, str) and value}
    return whole if "PROLIFIC_PID" in whole else None


def _is_for(audience: Any, host: str) -> bool:
    """Tell whether a token is made for `host`, which it names alone or in an address."""
    named = audience if isinstance(audience, list) else [audience]
    return any((urlsplit(str(each)).hostname or str(each)) == host for each in named)


PROLIFIC_NAMES: Final = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")
NAMES: Final[Mapping[Channel, tuple[str, ...]]] = MappingProxyType(
    {
        "link": PROLIFIC_NAMES,
        "prolific": PROLIFIC_NAMES,
        "mturk": ("workerId", "hitId", "assignmentId", "turkSubmitTo"),
        "invitations": ("invitation",),
    }
)
"""What stands in the address; the first one names the participant."""

VISIT: Final = re.compile(r"[A-Za-z0-9_-]{22,64}")
NAME: Final = re.compile(r"[\x21-\x7e]{1,200}")
PREVIEWED: Final = "ASSIGNMENT_ID_NOT_AVAILABLE"
"""What Mechanical Turk calls the assignment of somebody who only looks at the HIT."""


def names_in(values: Mapping[str, str]) -> dict[str, str]:
    """Return by what the participant is named in `values`; nothing where nobody sent them by name.

    Raises
    ------
    UnacceptableError
        If a name cannot be used.
    UninvitedError
        If the study takes only those whom its channel names.
    """
    recruitment = study_site().study.recruitment
    channel = recruitment.channel
    if channel == "prolific" and recruitment.prolific.signed_for:
        return _signed_names(values.get(SIGNED, ""), recruitment.prolific.signed_for)
    names = {name: values[name] for name in NAMES[channel] if values.get(name)}
    if any(not NAME.fullmatch(value) for value in names.values()):
        raise UnacceptableError(
            "The link holds a participant name that cannot be used.",
            "Please open the study once more from the page that sent you here.",
        )
    if _is_complete(channel, names):
        return _in_recruiters_letters(names)
    if channel == "link":
        return {}
    if channel == "invitations":
        raise UninvitedError(
            "This study can be opened only with an invitation.",
            "Please open the whole link that you were sent.",
        )
    raise _not_sent()


def _not_sent() -> UninvitedError:
    return UninvitedError(
        "This study is open only to people who come from a recruiting site.",
        "Please open it from its page there.",
    )


def _signed_names(token: str, host: str) -> dict[str, str]:
    names = signed_names(token, host)
    if names is None:
        raise _not_sent()
    return _in_recruiters_letters(names) | {SIGNED: token}


def _in_recruiters_letters(names: dict[str, str]) -> dict[str, str]:
    """Return `names` with the participant's as the recruiter writes it: one person, one name."""
    if "PROLIFIC_PID" in names:
        return names | {"PROLIFIC_PID": names["PROLIFIC_PID"].lower()}
    if "workerId" in names:
        return names | {"workerId": names["workerId"].upper()}
    return names


def is_preview(values: Mapping[str, str]) -> bool:
    """Tell whether somebody looks at the study without having decided to take part."""
    of_mturk = study_site().study.recruitment.channel == "mturk"
    return of_mturk and values.get("assignmentId") == PREVIEWED


def arrival_of(names: Mapping[str, str], *, visit: str, given: Mapping[str, str]) -> Arrival:
    """Return who comes, to the study.

    Parameters
    ----------
    names : mapping of str to str
        As `names_in` returned them.
    visit : str
        Says who it is where there are no names.
    given : mapping of question name to text
        What was answered so far.
    """
    study = study_site().study
    arriving = partial(
        Arrival,
        form=given,
        token=COOKIE.read(study.name),
        is_signed=SIGNED in names,
        address=None if study.recruitment.is_proven else newcomers_address(),
    )
    drawn = visit if VISIT.fullmatch(visit) else None
    if "PROLIFIC_PID" in names:
        return arriving(
            visit=_visit_as(names["PROLIFIC_PID"], drawn),
            recruiter_participant=names["PROLIFIC_PID"],
            recruiter_study=names.get("STUDY_ID", ""),
            recruiter_session=names.get("SESSION_ID", ""),
        )
    if "workerId" in names:
        return arriving(
            visit=_visit_as(names["workerId"], drawn),
            recruiter_participant=names["workerId"],
            recruiter_study=names["hitId"],
            recruiter_session=names["assignmentId"],
            submit_to=names["turkSubmitTo"],
        )
    if "invitation" in names:
        return arriving(visit=invited(study_site().database, names["invitation"]))
    return arriving(visit=drawn)


def _visit_as(participant: str, drawn: str | None) -> str | None:
    """Return the visit of somebody whom a recruiter names; with another name it is another one."""
    return drawn and token_hash(f"{participant} {drawn}")


def _is_complete(channel: Channel, names: Mapping[str, str]) -> bool:
    """Tell whether `names` say who it is, and where the end is to be reported to."""
    if channel == "mturk":
        return len(names) == len(NAMES[channel]) and names["turkSubmitTo"] in MTURK_SITES
    if channel == "invitations":
        return (
            "invitation" in names
            and invited(study_site().database, names["invitation"]) is not None
        )
    return "PROLIFIC_PID" in names


COOKIE: Final = TokenCookie("participant", path="/", kept=timedelta(days=7))
