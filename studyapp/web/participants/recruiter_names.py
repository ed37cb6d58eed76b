"""The names of participants in the address that brings them, by channel.

If the researcher turns it on, Prolific adds a token (a JWT, RS256) to the study's address, with the
participant's names, the host that it is for, and when it expires. The keys are public, so nobody
else can make up names.

A cookie shows that somebody who comes again by the same name has been here before. It holds the
token of their study session, like the addresses of their pages, and only the entrance reads it.
Nothing else needs it: in a frame of another site, or without cookies, a study works all the same.
"""

import logging
import re
import threading
import time
from collections.abc import Mapping
from datetime import timedelta
from functools import cache, partial
from typing import Any, Final
from urllib.parse import urlsplit

import jwt

from studyapp.recruitment.invitations import invited
from studyapp.researchers.credentials import token_hash
from studyapp.session.ending import MTURK_SITES
from studyapp.session.enrolment import Arrival
from studyapp.session.refusal import UnacceptableError, UninvitedError
from studyapp.study.settings.recruitment import Channel
from studyapp.web.site import TokenCookie, newcomers_address, study_site

SIGNED: Final = "prolific_token"
KEYS: Final = "https://api.prolific.com/.well-known/study/jwks.json"
KEYS_LAST: Final = 24 * 3600
ASKED_AGAIN: Final = 60.0
"""Seconds after which keys may be fetched again for a token whose key is unknown."""

FAILED_SECONDS: Final = 30.0
"""How long nobody waits for keys again that could not be fetched."""

GRACE_SECONDS: Final = 3600
"""How long a token counts after it expires, while its holder reads the first pages."""

LONGEST_TOKEN: Final = 4096
LOG: Final = logging.getLogger(__name__)


class ProlificKeys:
    """The keys that Prolific signs with, kept for a day."""

    def __init__(self) -> None:
        self._client = jwt.PyJWKClient(KEYS, lifespan=KEYS_LAST, timeout=5)
        self._lock = threading.Lock()
        self._fetched = self._failed = float("-inf")

    def find(self, kid: str) -> jwt.PyJWK | None:
        """Return the key with this id, None if Prolific has no such key.

        Raises
        ------
        PyJWKClientError
            If the keys cannot be fetched, or could not a moment ago.
        """
        with self._lock:
            if time.monotonic() - self._failed < FAILED_SECONDS:
                raise jwt.PyJWKClientError("the keys could not be fetched a moment ago")
            try:
                key = self._named(kid, refresh=False)
            except jwt.PyJWKClientError:
                self._failed = time.monotonic()
                raise
            if key is None and time.monotonic() - self._fetched > ASKED_AGAIN:
                self._fetched = time.monotonic()
                key = self._named(kid, refresh=True)
        return key

    def _named(self, kid: str, *, refresh: bool) -> jwt.PyJWK | None:
        keys = self._client.get_jwk_set(refresh=refresh).keys
        return next((key for key in keys if key.key_id == kid), None)


@cache
def prolific_keys() -> ProlificKeys:
    """Return the keys that Prolific signs with."""
    return ProlificKeys()


def signed_names(token: str, host: str) -> dict[str, str] | None:
    """Return Prolific's names for the holder of `token`, None if Prolific did not sign it.

    Parameters
    ----------
    host : str
        The host that the token must be for.

    Raises
    ------
    UnacceptableError
        If the keys cannot be fetched.
    """
    if not token or len(token) > LONGEST_TOKEN:
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
            leeway=GRACE_SECONDS,
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
    claimed = claims.get("prolific")
    if not _is_for(claims["aud"], host) or not isinstance(claimed, dict):
        return None
    names = {
        name: value
        for name in PROLIFIC_NAMES
        if isinstance(value := claimed.get(name), str) and value
    }
    return names if "PROLIFIC_PID" in names else None


def _is_for(audience: Any, host: str) -> bool:
    """Return whether a token is for `host`, which it names alone or in an address."""
    addresses = map(str, audience if isinstance(audience, list) else [audience])
    return any((urlsplit(address).hostname or address) == host for address in addresses)


PROLIFIC_NAMES: Final = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")
NAMES: Final[Mapping[Channel, tuple[str, ...]]] = {
    "link": PROLIFIC_NAMES,
    "prolific": PROLIFIC_NAMES,
    "mturk": ("workerId", "hitId", "assignmentId", "turkSubmitTo"),
    "invitations": ("invitation",),
}
"""Parameters of the address: the participant, the recruiter's study, the submission."""

VISIT: Final = re.compile(r"[A-Za-z0-9_-]{22,64}")
NAME: Final = re.compile(r"[\x21-\x7e]{1,200}")
PREVIEW_ASSIGNMENT: Final = "ASSIGNMENT_ID_NOT_AVAILABLE"
"""Mechanical Turk's assignment of workers who only preview the HIT."""


def read_names(values: Mapping[str, str]) -> dict[str, str]:
    """Return the names of the participant in `values`; none if nobody sent them by name.

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
            "The link holds a participant ID that cannot be used.",
            "Please open the study once more from the page that sent you here.",
        )
    if _is_complete(channel, names):
        return _normalised(names)
    if channel == "link":
        return {}
    raise _not_sent()


def _not_sent() -> UninvitedError:
    return UninvitedError(
        "This study is open only to people who were invited, or come from a recruiting site.",
        "Please open the whole link that you were sent, or the study's page there.",
    )


def _signed_names(token: str, host: str) -> dict[str, str]:
    names = signed_names(token, host)
    if names is None:
        raise _not_sent()
    return _normalised(names) | {SIGNED: token}


def _normalised(names: dict[str, str]) -> dict[str, str]:
    """Return `names` with the participant's in the recruiter's case: one person, one name."""
    if "PROLIFIC_PID" in names:
        return names | {"PROLIFIC_PID": names["PROLIFIC_PID"].lower()}
    if "workerId" in names:
        return names | {"workerId": names["workerId"].upper()}
    return names


def is_preview(values: Mapping[str, str]) -> bool:
    """Return whether somebody previews the study, and has not accepted to take part."""
    is_mturk = study_site().study.recruitment.channel == "mturk"
    return is_mturk and values.get("assignmentId") == PREVIEW_ASSIGNMENT


def arrival_of(names: Mapping[str, str], *, visit: str, form: Mapping[str, str]) -> Arrival:
    """Return the arrival of a person at the study.

    Parameters
    ----------
    names : mapping of str to str
        The names that `read_names` returned.
    visit : str
        Identifies a person without names.
    form : mapping of question name to text
        The answers so far.
    """
    study = study_site().study
    channel = study.recruitment.channel
    arriving = partial(
        Arrival,
        form=form,
        token=COOKIE.read(study.name),
        is_signed=SIGNED in names,
        address=None if study.recruitment.is_proven else newcomers_address(),
    )
    if channel == "invitations":
        return arriving(visit=invited(study_site().database, names["invitation"]))
    drawn = visit if VISIT.fullmatch(visit) else None
    if not names:
        return arriving(visit=drawn)
    participant, recruiter_study, submission = (names.get(name, "") for name in NAMES[channel][:3])
    return arriving(
        # The visit of a named participant differs by name.
        visit=drawn and token_hash(f"{participant} {drawn}"),
        recruiter_participant=participant,
        recruiter_study=recruiter_study,
        recruiter_session=submission,
        submit_to=names.get("turkSubmitTo", ""),
    )


def _is_complete(channel: Channel, names: Mapping[str, str]) -> bool:
    """Return whether `names` identify the participant, and say where to report the end."""
    if channel == "mturk":
        return len(names) == len(NAMES[channel]) and names["turkSubmitTo"] in MTURK_SITES
    if channel == "invitations":
        return (
            "invitation" in names
            and invited(study_site().database, names["invitation"]) is not None
        )
    return "PROLIFIC_PID" in names


COOKIE: Final = TokenCookie("participant", path="/", lifetime=timedelta(days=7))
