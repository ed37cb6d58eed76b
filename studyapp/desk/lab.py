"""The desk: its folder, its accounts, its studies, and who belongs to which.

What is served of a study follows the study's files.
"""

from __future__ import annotations

import base64
import hmac
import os
import re
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal, cast

from flask import Flask, current_app
from sqlalchemy import func, select
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, refuse_second_database, sqlite_url
from studyapp.database.tables.researchers import Event
from studyapp.database.tables.study_session import StudySession
from studyapp.monitoring.alarms import AlarmChannels
from studyapp.monitoring.overview import places_so_far
from studyapp.researchers.account import Account, find_account_by_identity
from studyapp.researchers.audit import log_change
from studyapp.session.intake import current_intake
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import needs_new_version, open_study
from studyapp.study.folder import StudyFolder
from studyapp.web.app import create_app
from studyapp.web.site import EXTENSION, Desk, Site

ACCOUNTS: Final = "desk.db"
"""The desk's database in its folder: the tables of a study's, of which those of accounts are used.
"""


NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}")
"""Names of folders that can be part of an address as they are."""

RESERVED: Final = ("healthz", "research", "static")
"""What the desk itself has below its root."""

PAGE: Final = "/research/studies/{name}/"
"""A study's page at the desk."""

QUICK_SECONDS: Final = 0.2
"""A study that takes longer to read is not read again at every request while it changes."""

PAUSE: Final = 20
"""For how many times as long as reading took, it is then not read again."""

State = Literal["being made", "changed", "ready", "running", "paused", "closed", "done"]


def check_study_name(name: str) -> str:
    """Return `name`, or raise `InputError` unless a study of a desk can be called so."""
    if NAME.fullmatch(name) is None or name in RESERVED:
        raise InputError(
            f"a study of a desk cannot be called {name!r}",
            remedy="Use letters, digits, '-' and '_', such as gestures-2; the desk itself uses "
            f"{', '.join(RESERVED)}",
        )
    return name


@dataclass(frozen=True, kw_only=True)
class Standing:
    """How far a study is.

    Attributes
    ----------
    state : str
        ``being made`` until it can be served, ``changed`` if it can only be served as a new
        version.
    problem : InputError or None
        Why it cannot be served as its files are now.
    done, wanted : int
        Places; both 0 while it is being made.
    """

    state: State
    problem: InputError | None = None
    done: int = 0
    wanted: int = 0


class LabStudy:
    """One study of a desk, as one process of the server has it.

    What is served follows the study's files. Where they cannot be served, or only as a new
    version, what was served before goes on.
    """

    def __init__(self, root: Path, desk: Database, clock: Clock, origin: str) -> None:
        self.name: Final = root.name
        self.folder: Final = StudyFolder(root)
        self._desk = Desk(database=desk, address=PAGE.format(name=root.name))
        self._clock = clock
        self._origin = origin
        self._lock = threading.RLock()
        self._database: Database | None = None
        self._read_stamp: object = None
        self._app: Flask | None = None
        self._served: ServedStudy | None = None
        self._problem: InputError | None = None
        self._awaits_new_version = False
        self._next_read = 0.0

    @property
    def database(self) -> Database:
        """The study's database, made where there is none."""
        with self._lock:
            if self._database is None:
                refuse_second_database(self.folder)
                self._database = Database.open(sqlite_url(self.folder.responses))
            return self._database

    def application(self) -> Flask | None:
        """Return what serves the study below its name; None while nothing can be served."""
        self._reread()
        with self._lock:
            if self._app is None and self._served is not None:
                self._app = self._make_app(self._served)
            return self._app

    def served(self) -> ServedStudy | None:
        """Return what is served of the study, None while nothing can be."""
        self._reread()
        return self._served

    def begin_new_version(self, *, by: str) -> None:
        """Serve the files as they are as a new version; earlier answers are kept apart.

        Raises
        ------
        InputError
            If it cannot be served.
        """
        served = ServedStudy.read(self.folder.root).opened_for(rehearsal=False)
        open_study(self.database, served, self._clock, new_version=True, by=by)
        # So that all processes of the server read the files again.
        os.utime(self.folder.definition)

    def standing(self) -> Standing:
        """Return how far the study is."""
        served, problem = self.served(), self._problem
        if served is None:
            state: State = "changed" if self._awaits_new_version else "being made"
            return Standing(state=state, problem=problem)
        places = places_so_far(self.database, served, self._clock.now())
        with self.database.reading() as session:
            state = _state(session, served, is_done=places.done >= places.wanted)
        return Standing(state=state, problem=problem, done=places.done, wanted=places.wanted)

    def _reread(self) -> None:
        """Read the study again if its files have changed."""
        with self._lock:
            began = time.monotonic()
            if began < self._next_read or (stamp := self._stamp()) == self._read_stamp:
                return
            self._read_stamp, self._awaits_new_version = stamp, False
            try:
                served = ServedStudy.read(self.folder.root).opened_for(rehearsal=False)
                AlarmChannels.of(served.study)
                self._awaits_new_version = needs_new_version(self.database, served.design)
                open_study(self.database, served, self._clock)
                if self._app is not None:
                    self._app = self._make_app(served)
                self._served, self._problem = served, None
            except InputError as error:
                self._problem = error
            except OSError as error:
                self._problem = InputError(f"a file cannot be read ({error})")
            seconds = time.monotonic() - began
            # While videos are rendered, the files change all the time.
            self._next_read = began + (PAUSE * seconds if seconds > QUICK_SECONDS else 0)

    def _make_app(self, served: ServedStudy) -> Flask:
        return create_app(
            self.folder.root,
            database_url=sqlite_url(self.folder.responses),
            prefix=f"/{self.name}",
            served=served,
            origin=self._origin,
            desk=self._desk,
        )

    def _stamp(self) -> tuple[tuple[int, int], ...]:
        """Return what changes with the files that define what is served."""
        files = (
            self.folder.definition,
            self.folder.stimuli,
            self.folder.speech / "segments.csv",
            self.folder.videos,
            # Unlike `iterdir`, this finds nothing in a folder that cannot be read.
            *sorted(self.folder.videos.glob("*/")),
        )
        return tuple(map(_file_stamp, files))


def _file_stamp(path: Path) -> tuple[int, int]:
    try:
        state = path.stat()
    except OSError:
        return (0, 0)
    return (state.st_ino, state.st_mtime_ns)


def _state(session: Session, served: ServedStudy, *, is_done: bool) -> State:
    intake = current_intake(session).state
    if intake == "closed" or not served.study.open:
        return "closed"
    if is_done:
        return "done"
    if intake == "paused":
        return "paused"
    has_begun = session.scalar(select(func.count(StudySession.id)))
    return "running" if has_begun else "ready"


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
        root = self.folder / name
        # Unlike `Path.is_file`, this finds nothing in a folder that cannot be read.
        if not os.path.isfile(StudyFolder(root).definition):  # noqa: PTH113
            return None
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

    def log(self, session: Session, event: Event, detail: str) -> None:
        """Log what the researcher does in the study."""
        log_change(session, current_lab().clock.now(), event, by=self.account.name, detail=detail)


def study_token(token: str, study: str) -> str:
    """Return the token of the login in `study` that belongs to the desk's login of `token`.

    It follows from the desk's token, which nobody can tell from it.
    """
    digest = hmac.digest(token.encode(), f"study {study}".encode(), "sha256")
    return base64.urlsafe_b64encode(digest).decode("ascii").rstrip("=")


def current_lab() -> Lab:
    """Return the desk that the present request is for."""
    return cast(Lab, current_app.extensions[EXTENSION])
