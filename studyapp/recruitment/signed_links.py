"""Links that Prolific has signed: nobody else can make up who comes.

Where the researcher turns it on, Prolific adds a token (a JWT, RS256) to the study's address. It
says by what the participant is named, for which host, and until when. The keys are public.
"""

from __future__ import annotations

import logging
import threading
import time
from functools import cache
from typing import Any, Final
from urllib.parse import urlsplit

import jwt

from studyapp.session.refusal import UnacceptableError

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
    return any((urlsplit(str(one)).hostname or str(one)) == host for one in named)
