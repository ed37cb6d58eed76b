"""The desk itself: its folder, its accounts, its studies, and who belongs to which."""

from __future__ import annotations

import base64
import hmac
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, cast

from flask import current_app
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.desk.studies import NAME, RESERVED, LabStudy
from studyapp.researchers.account import Account, find_account_by_identity
from studyapp.study.folder import StudyFolder
from studyapp.web.site import EXTENSION, Site

ACCOUNTS: Final = "desk.db"
"""The desk's database in its folder: the tables of a study's, of which those of accounts are used.
"""


@dataclass(frozen=True, kw_only=True)
class Lab(Site):
    """A folder of studies with a desk.

    Attributes
    ----------
    folder : Path
        Holds the studies as sub-folders.
    """

    kind = "desk"
    folder: Path
    _known: dict[tuple[str, int], LabStudy] = field(default_factory=dict, init=False, repr=False)
    _lock: threading.Lock = field(default_factory=threading.Lock, init=False, repr=False)

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.name

    @property
    def title(self) -> str:
        """What stands above the desk's pages."""
        return f"Desk of {self.folder.name}"

    def study(self, name: str) -> LabStudy | None:
        """Return the study `name`, None where there is none."""
        if NAME.fullmatch(name) is None or name in RESERVED:
            return None
        if not StudyFolder(self.folder / name).definition.is_file():
            return None
        root = self.folder / name
        # Another folder of the same name is another study.
        key = (name, root.stat().st_ino)
        with self._lock:
            if key not in self._known:
                self._known[key] = LabStudy(root, self.database, self.clock, self.origin)
            return self._known[key]

    def studies(self) -> list[LabStudy]:
        """Return all studies, by name."""
        studies = (self.study(path.name) for path in sorted(self.folder.iterdir()))
        return [study for study in studies if study is not None]

    def opened_study(self, name: str, account: Account) -> OpenedStudy | None:
        """Return the study `name` as the holder of a desk's account sees it, None where not.

        Raises
        ------
        InputError
            If the study's database, which tells their rights, cannot be read.
        """
        study = self.study(name)
        if study is None or account.identity is None:
            return None
        try:
            in_study = find_account_by_identity(study.database, account.identity)
        except SQLAlchemyError as error:
            raise InputError(
                f"the database of {name} cannot be read",
                where=study.folder.responses,
                remedy="Try again; if it stays so, restore a backup of the study",
            ) from error
        return None if in_study is None else OpenedStudy(study=study, account=in_study)


@dataclass(frozen=True, kw_only=True)
class OpenedStudy:
    """A study, and the account in it of the researcher who asks, whose rights count."""

    study: LabStudy
    account: Account

    @property
    def name(self) -> str:
        """The folder's name, as it stands in addresses."""
        return self.study.name

    @property
    def folder(self) -> StudyFolder:
        """The study folder."""
        return self.study.folder

    @property
    def database(self) -> Database:
        """The study's own database."""
        return self.study.database


def study_token(token: str, study: str) -> str:
    """Return the token of the login in `study` that belongs to the desk's login of `token`.

    It follows from the desk's token, which nobody can tell from it.
    """
    digest = hmac.digest(token.encode(), f"study {study}".encode(), "sha256")
    return base64.urlsafe_b64encode(digest).decode("ascii").rstrip("=")


def current_lab() -> Lab:
    """Return the desk that the present request is for."""
    return cast(Lab, current_app.extensions[EXTENSION])
