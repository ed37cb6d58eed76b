"""Pseudonyms of participants in exports, which nobody can reverse without the key."""

import base64
import hashlib
import hmac
import json
import os
import secrets
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Self

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession

KEY_BYTES: Final = 32
PSEUDONYM_BYTES: Final = 10

FOLDER: Final = "sub-"
"""Prefix of pseudonyms in folders for another lab."""

PREFIX: Final = "p"
"""A letter, so that no spreadsheet mistakes a pseudonym for a number."""

OTHER_USERS: Final = 0o077


@dataclass(frozen=True)
class PseudonymKey:
    """A study's secret key, from which pseudonyms are computed."""

    secret: bytes = field(repr=False)

    @classmethod
    def read(cls, path: Path) -> Self | None:
        """Read the key in `path`; None if there is none yet.

        Raises
        ------
        InputError
            If the file is not a key, or other users may read it.
        """
        try:
            text = path.read_text("ascii").strip()
            mode = path.stat().st_mode
        except FileNotFoundError:
            return None
        except UnicodeDecodeError:
            text, mode = "", 0
        if mode & OTHER_USERS:
            raise InputError(
                "other users of this machine can read the key of the pseudonyms",
                where=path,
                remedy=f"Protect it: chmod 600 {path}",
            )
        try:
            secret = bytes.fromhex(text)
        except ValueError:
            secret = b""
        if len(secret) != KEY_BYTES:
            raise InputError(
                "this is not a key of pseudonyms",
                where=path,
                remedy="Restore it from a backup; or remove it, and participants get other "
                "pseudonyms than in earlier exports",
            )
        return cls(secret)

    @classmethod
    def read_or_make(cls, path: Path) -> Self:
        """Read the key in `path`, or create one that only the owner can read."""
        existing = cls.read(path)
        if existing is not None:
            return existing
        draft = path.with_name(f".{path.name}-{secrets.token_hex(8)}")
        handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            with os.fdopen(handle, "w", encoding="ascii") as stream:
                stream.write(secrets.token_bytes(KEY_BYTES).hex() + "\n")
                stream.flush()
                os.fsync(stream.fileno())
            # Of two simultaneous exports, the first key wins.
            with suppress(FileExistsError):
                os.link(draft, path)
        finally:
            draft.unlink()
        created = cls.read(path)
        if created is None:
            raise InputError("the key cannot be stored", where=path, remedy="Check the folder")
        return created

    def pseudonym(self, participant: StudySession) -> str:
        """Return the participant's pseudonym: ``p`` and sixteen letters and digits.

        It is the first 80 bits of an HMAC with SHA-256 (RFC 2104) of the recruiter's name for the
        person, or of the random visit: the same in every export.
        """
        identity = ("token", participant.token)
        if participant.recruiter_participant is not None:
            identity = ("recruiter", participant.recruiter_participant)
        elif participant.visit is not None:
            identity = ("visit", participant.visit)
        digest = hmac.digest(self.secret, json.dumps(identity).encode(), hashlib.sha256)
        return PREFIX + base64.b32encode(digest[:PSEUDONYM_BYTES]).decode("ascii").lower()

    def pseudonyms(self, study_sessions: Iterable[StudySession]) -> dict[int, str]:
        """Return the pseudonym of each study session's participant, by its number."""
        return {each.id: self.pseudonym(each) for each in study_sessions}

    def is_called(self, participant: StudySession, name: str) -> bool:
        """Tell whether `name`, from an export, is the participant's."""
        pseudonym = name.removeprefix(FOLDER)
        return hmac.compare_digest(self.pseudonym(participant).encode(), pseudonym.encode())


def pseudonyms_of(
    database: Database, key: PseudonymKey, numbers: Collection[int]
) -> Mapping[int, str]:
    """Return the pseudonyms of the participants of the study sessions `numbers`."""
    with database.reading() as session:
        chosen = select(StudySession).where(StudySession.id.in_(numbers))
        return key.pseudonyms(session.scalars(chosen))


def find_number_by_name(session: Session, key: PseudonymKey | None, name: str) -> int | None:
    """Return the number of the study session called `name`; None if there is none.

    Parameters
    ----------
    key : PseudonymKey or None
        None if pseudonyms may not be used, or there are none.
    name : str
        Its number, or the participant's pseudonym in an export or its folders.
    """
    name = name.strip().removeprefix(FOLDER).lower()
    if name.isascii() and name.isdecimal():
        return _existing_number(session, name)
    named = {} if key is None else key.pseudonyms(session.scalars(select(StudySession)))
    return next((number for number, pseudonym in named.items() if pseudonym == name), None)


def fold_name(name: str) -> str:
    """Return the same text for all ways to write a name: recruiters' ids ignore case."""
    return name.strip().lower()


def find_number_by_recruiter(session: Session, name: str) -> int | None:
    """Return the last study session of the participant whom a recruiter calls `name`, or None."""
    return session.scalar(
        select(func.max(StudySession.id)).where(
            func.lower(StudySession.recruiter_participant) == fold_name(name)
        )
    )


def _existing_number(session: Session, digits: str) -> int | None:
    """Return the number if there is such a study session; overlong numbers match none."""
    if len(digits) >= len(str(2**31)):
        return None
    return session.scalars(select(StudySession.id).where(StudySession.id == int(digits))).first()
