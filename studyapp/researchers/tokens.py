"""Secrets that browsers and links hold, and what of them is stored."""

from __future__ import annotations

import hashlib
import secrets
from typing import Final

BYTES: Final = 32


def new_token() -> str:
    """Return 256 random bits as letters that an address may hold."""
    return secrets.token_urlsafe(BYTES)


def token_hash(token: str) -> str:
    """Return what is stored of `token`, from which nobody can tell it.

    It is random enough that a plain hash cannot be guessed backwards, unlike that of a password.
    """
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()
