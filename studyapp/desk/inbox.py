"""A study's inbox: files that were uploaded, piece by piece, and are not in the study yet.

A script sends the pieces, each with where it begins, and is told where to go on. Importing is a
job, see `studyapp.desk.job_kinds`.

An unfinished upload is a hidden file, named after the file, its size and its time of modification.
Its own size is where to go on: an upload survives a lost connection, another browser and a crash of
the server, and a changed file begins anew. Nothing here is opened or trusted: ``motionjury import``
reads the files, and refuses what it cannot use.
"""

import fcntl
import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISREG
from typing import Annotated, Final

from flask import abort, jsonify, redirect, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from motion.errors import InputError
from motion.segment import EMOTIONS, SEGMENTS_FILE, check_name
from studyapp.desk.job_kinds import BRING_IN
from studyapp.desk.job_page import MOST_SHOWN
from studyapp.desk.jobs import job_log, job_standings
from studyapp.desk.lab import OpenedStudy
from studyapp.desk.page import page
from studyapp.researchers.account import Right
from studyapp.study.folder import IMPORTABLE_ENDINGS, StudyFolder
from studyapp.web.research.pages import Page

PARTIAL: Final = re.compile(r"\.(?P<name>.+)\.(?P<size>\d+)\.(?P<changed>\d+)\.part")

LARGEST_PIECE: Final = 1024 * 1024
"""Bytes that one request to the desk may bring; a study's pages take less."""


KEPT_FREE: Final = 10**9
"""Bytes of the disk that uploads leave free for participants' answers."""


class Upload(BaseModel):
    """A file that somebody uploads.

    Attributes
    ----------
    condition : str
        The condition that it belongs to; empty for speech.
    size : int
        In bytes.
    changed : int
        When it was last modified, in milliseconds since 1970.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    condition: str = ""
    name: str
    size: Annotated[int, Field(ge=0)]
    changed: Annotated[int, Field(ge=0, lt=10**15)]


class Piece(Upload):
    """A piece of such a file, which begins at `offset`."""

    offset: Annotated[int, Field(ge=0)]


@dataclass(frozen=True, kw_only=True)
class InboxFile:
    """A file in the inbox.

    Attributes
    ----------
    condition : str
        Empty for speech.
    received, size : int
        Bytes that have arrived, and bytes of the whole file.
    """

    condition: str
    name: str
    received: int
    size: int

    @property
    def path(self) -> str:
        """Where it is in the inbox."""
        return f"{self.condition}/{self.name}".removeprefix("/")

    @property
    def is_complete(self) -> bool:
        """Whether all of it has arrived."""
        return self.received == self.size


class Inbox:
    """The inbox of one study."""

    def __init__(self, folder: StudyFolder) -> None:
        self._root = folder.inbox

    def _received(self, upload: Upload) -> int:
        """Return how many bytes of a file have arrived."""
        complete, partial = self._paths(upload)
        if complete.exists():
            state = complete.stat()
            if (state.st_size, state.st_mtime_ns) != (upload.size, upload.changed * 10**6):
                raise InputError(
                    f"another {upload.name} is here already",
                    remedy="Bring that one into the study, or remove it first",
                )
            return upload.size
        try:
            return partial.stat().st_size
        except FileNotFoundError:
            # There is none yet, or its last piece has just made it the complete file.
            return upload.size if complete.exists() else 0

    def append(self, upload: Upload, offset: int, piece: bytes) -> int:
        """Add a piece to a file if it ends at `offset` so far; return how many bytes have arrived.

        Raises
        ------
        InputError
            If the file can never be brought in, another one of its name is here, the disk has no
            room for the rest, or the piece is empty or more than the rest.
        """
        received = self._received(upload)
        if received != offset:
            return received
        if not 0 < len(piece) <= upload.size - offset:
            raise InputError(
                f"{len(piece)} bytes came of {upload.name}, {upload.size - offset} were left",
                remedy="Choose the file again",
            )
        complete, partial = self._paths(upload)
        partial.parent.mkdir(parents=True, exist_ok=True)
        if shutil.disk_usage(partial.parent).free - (upload.size - offset) < KEPT_FREE:
            raise InputError(
                f"the server's disk has no room for {upload.name}",
                remedy="Make room there, then go on with this upload",
            )
        with partial.open("ab") as file:
            # Another window, or a piece that seemed lost, may write at this moment.
            fcntl.flock(file, fcntl.LOCK_EX)
            received = os.fstat(file.fileno()).st_size
            if received != offset:
                return received
            file.write(piece)
            if received + len(piece) == upload.size:
                file.flush()
                os.fsync(file.fileno())
                os.utime(partial, ns=(upload.changed * 10**6,) * 2)
                partial.rename(complete)
        return offset + len(piece)

    def files(self) -> list[InboxFile]:
        """Return all files, speech first."""
        if not self._root.is_dir():
            return []
        conditions = sorted(path for path in self._root.iterdir() if path.is_dir())
        return [file for folder in (self._root, *conditions) for file in self._listed(folder)]

    def remove(self, condition: str, name: str) -> None:
        """Remove a file, and its unfinished uploads."""
        complete, _ = self._paths(Upload(condition=condition, name=name, size=1, changed=0))
        complete.unlink(missing_ok=True)
        for path in complete.parent.glob(".*.part"):
            if (match := PARTIAL.fullmatch(path.name)) and match["name"] == name:
                path.unlink(missing_ok=True)

    def _listed(self, folder: Path) -> Iterator[InboxFile]:
        for path in sorted(folder.iterdir()):
            match = PARTIAL.fullmatch(path.name)
            if match is None and path.name.startswith("."):
                continue
            try:
                state = path.stat()
            except FileNotFoundError:
                # It has just been imported, or completed under its own name.
                continue
            if S_ISREG(state.st_mode):
                yield InboxFile(
                    condition="" if folder == self._root else folder.name,
                    name=match["name"] if match else path.name,
                    received=state.st_size,
                    size=int(match["size"]) if match else state.st_size,
                )

    def _paths(self, upload: Upload) -> tuple[Path, Path]:
        """Return where a file lies when it is complete, and until then."""
        suffix = Path(upload.name).suffix
        # A video with another segment's speech names both with @ between them.
        for name in upload.name.removesuffix(suffix).split("@", 1):
            check_name(name, "file")
        if suffix.lower() not in IMPORTABLE_ENDINGS:
            raise InputError(
                f"the file {upload.name} is neither speech, motion nor a video that can be "
                "brought in",
                remedy=f"Files end in {', '.join(IMPORTABLE_ENDINGS)}",
            )
        folder = self._root
        if upload.condition:
            folder /= check_name(upload.condition, "condition")
        partial = f".{upload.name}.{upload.size}.{upload.changed}.part"
        return folder / upload.name, folder / partial


REFUSED: Final = "refused: "
"""Begins the lines of the import's log that say why a file was not brought in."""


def bring_in(study: OpenedStudy) -> ResponseReturnValue:
    """Show the inbox, and how the last import went."""
    files = Inbox(study.folder).files()
    log = job_log(study.folder.jobs, BRING_IN.name, most=MOST_SHOWN)
    # Files may have been removed since.
    waiting = tuple(f"{REFUSED}{study.folder.inbox.name}/{file.path}" for file in files)
    return page(
        "bring_in",
        study=study,
        files=files,
        # A table of segments says all of it.
        asks_about_speech=any(file.condition == "" for file in files)
        and not any(file.name == SEGMENTS_FILE for file in files),
        conditions=_conditions(study),
        emotions=EMOTIONS,
        endings=IMPORTABLE_ENDINGS,
        piece=LARGEST_PIECE,
        last=job_standings(study.folder.jobs).get(BRING_IN.name),
        refusals=[
            line.removeprefix(f"{REFUSED}{study.folder.inbox.name}/")
            for line in log.splitlines()
            if line.startswith(waiting)
        ],
    )


def take_piece(study: OpenedStudy) -> ResponseReturnValue:
    """Add a piece to a file, and tell where the next one begins."""
    try:
        piece = Piece.model_validate(request.args.to_dict())
    except ValidationError:
        abort(400)
    try:
        received = Inbox(study.folder).append(piece, piece.offset, request.get_data())
    except InputError as error:
        return jsonify(problem=f"{error.what[:1].upper()}{error.what[1:]}. {error.remedy}."), 422
    return jsonify(offset=received)


def remove_upload(study: OpenedStudy) -> ResponseReturnValue:
    """Remove a file from the inbox."""
    Inbox(study.folder).remove(request.form.get("condition", ""), request.form.get("name", ""))
    return redirect(url_for("research.bring_in", study=study.name), 303)


def _conditions(study: OpenedStudy) -> list[str]:
    """Return the conditions that take files; none where the study file is wrong."""
    try:
        definition = study.folder.study()
    except InputError:
        return []
    conditions = (*definition.conditions, definition.catch.condition)
    return [name for name in conditions if name not in definition.generated()]


PAGES: Final = (
    Page("GET", "/bring-in", bring_in, Right.STEER),
    Page("POST", "/bring-in/remove", remove_upload, Right.STEER),
    Page("POST", "/uploads", take_piece, Right.STEER),
)
