"""A study's inbox: files that were uploaded, piece by piece, and are not in the study yet.

What has come of a file lies in a hidden one beside it, named after the file, its size and when it
was changed. So where to go on is the size of that file: an upload survives a lost line, another
browser and a crash of the server, and a changed file begins anew. Nothing here is opened or
believed: ``motionjury import`` reads the files, and refuses what it cannot use.
"""

from __future__ import annotations

import fcntl
import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field

from motion.errors import InputError
from motion.segment import check_name
from studyapp.study.folder import IMPORTABLE_ENDINGS, StudyFolder

NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.@+ ()-]{0,149}")
PARTIAL: Final = re.compile(rf"\.(?P<name>{NAME.pattern})\.(?P<size>\d+)\.(?P<changed>\d+)\.part")

LARGEST_PIECE: Final = 1024 * 1024
"""Bytes that one request to the desk may bring; a study's pages take less."""

LARGEST_FILE: Final = 10 * 10**9
"""Bytes that an uploaded file may have."""

KEPT_FREE: Final = 10**9
"""Bytes of the disk that uploads leave free: participants' answers need room too."""


class WrongOffsetError(Exception):
    """A piece does not begin where the file ends so far, which is at `offset`."""

    def __init__(self, offset: int) -> None:
        super().__init__()
        self.offset = offset


class Upload(BaseModel):
    """A file that somebody uploads.

    Attributes
    ----------
    condition : str
        The condition that it belongs to; empty for speech.
    size : int
        Bytes.
    changed : int
        When it was changed last, in milliseconds since 1970.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    condition: str = ""
    name: str
    size: Annotated[int, Field(ge=0)]
    changed: Annotated[int, Field(ge=0, lt=10**15)]


@dataclass(frozen=True, kw_only=True)
class InboxFile:
    """A file in the inbox.

    Attributes
    ----------
    condition : str
        Empty for speech.
    here, size : int
        Bytes that have come, of how many.
    """

    condition: str
    name: str
    here: int
    size: int

    @property
    def is_whole(self) -> bool:
        """Whether all of it is here."""
        return self.here == self.size


class Inbox:
    """The inbox of one study.

    Parameters
    ----------
    folder : StudyFolder
    largest : int
        Bytes that a file may have.
    """

    def __init__(self, folder: StudyFolder, *, largest: int = LARGEST_FILE) -> None:
        self._root = folder.inbox
        self._largest = largest

    def received(self, upload: Upload) -> int:
        """Return how many bytes of a file are here.

        Raises
        ------
        InputError
            If it can never be brought in, is too large, or another file of its name is here.
        """
        whole, partial = self._places(upload)
        if whole.exists():
            state = whole.stat()
            if (state.st_size, state.st_mtime_ns) != (upload.size, upload.changed * 10**6):
                raise InputError(
                    f"another {upload.name} is here already",
                    remedy="Bring that one into the study, or remove it first",
                )
            return upload.size
        return partial.stat().st_size if partial.exists() else 0

    def append(self, upload: Upload, offset: int, piece: bytes) -> int:
        """Add a piece to a file, and return how many bytes of it are here then.

        Raises
        ------
        WrongOffsetError
            If the file does not end at `offset` so far.
        InputError
            As `received`, and if the disk has no room for the rest, or the piece is empty or more
            than the rest.
        """
        here = self.received(upload)
        if here != offset:
            raise WrongOffsetError(here)
        if not 0 < len(piece) <= upload.size - offset:
            raise InputError(
                f"{len(piece)} bytes came of {upload.name}, {upload.size - offset} were left",
                remedy="Choose the file again",
            )
        whole, partial = self._places(upload)
        partial.parent.mkdir(parents=True, exist_ok=True)
        if shutil.disk_usage(partial.parent).free - (upload.size - offset) < KEPT_FREE:
            raise InputError(
                f"the server's disk has no room for {upload.name}",
                remedy="Make room there, then go on with this upload",
            )
        with partial.open("ab") as file:
            # Another window, or a piece that was taken for lost, may write at this moment.
            fcntl.flock(file, fcntl.LOCK_EX)
            here = os.fstat(file.fileno()).st_size
            if here != offset:
                raise WrongOffsetError(here)
            file.write(piece)
            if here + len(piece) == upload.size:
                file.flush()
                os.fsync(file.fileno())
                os.utime(partial, ns=(upload.changed * 10**6,) * 2)
                partial.rename(whole)
        return offset + len(piece)

    def files(self) -> list[InboxFile]:
        """Return what is here, speech first."""
        places = [self._root, *self._conditions()] if self._root.is_dir() else []
        return [file for place in places for file in self._listed(place)]

    def remove(self, condition: str, name: str) -> None:
        """Remove a file, and what has come of it so far."""
        wanted = Upload(condition=condition, name=name, size=1, changed=0)
        whole, _ = self._places(wanted)
        whole.unlink(missing_ok=True)
        for path, file in self._partial(whole.parent):
            if file.name == name:
                path.unlink(missing_ok=True)

    def _conditions(self) -> list[Path]:
        return sorted(path for path in self._root.iterdir() if path.is_dir())

    def _listed(self, place: Path) -> Iterator[InboxFile]:
        condition = "" if place == self._root else place.name
        for path in sorted(place.iterdir()):
            if path.is_file() and not path.name.startswith("."):
                size = path.stat().st_size
                yield InboxFile(condition=condition, name=path.name, here=size, size=size)
        yield from (file for _, file in self._partial(place))

    def _partial(self, place: Path) -> Iterator[tuple[Path, InboxFile]]:
        condition = "" if place == self._root else place.name
        for path in sorted(place.glob(".*.part")):
            found = PARTIAL.fullmatch(path.name)
            if found is not None:
                here = path.stat().st_size
                file = InboxFile(
                    condition=condition, name=found["name"], here=here, size=int(found["size"])
                )
                yield path, file

    def _places(self, upload: Upload) -> tuple[Path, Path]:
        """Return where a file lies when it is whole, and until then."""
        if NAME.fullmatch(upload.name) is None:
            raise InputError(
                f"a file cannot be called {upload.name[:200]!r} here",
                remedy="Use letters, digits and _ - + @ ( ) for its name, at most 150 of them",
            )
        if Path(upload.name).suffix.lower() not in IMPORTABLE_ENDINGS:
            raise InputError(
                f"{upload.name} is neither speech, motion nor a video that can be brought in",
                remedy=f"Files end in {', '.join(IMPORTABLE_ENDINGS)}",
            )
        if not 0 < upload.size <= self._largest:
            limit = f"{self._largest / 10**9:g} GB"
            raise InputError(
                f"{upload.name} is empty" if not upload.size else f"{upload.name} is too large",
                remedy=f"A file may have up to {limit}; import larger ones on the server",
            )
        place = self._root
        if upload.condition:
            place /= check_name(upload.condition, "condition")
        partial = f".{upload.name}.{upload.size}.{upload.changed}.part"
        return place / upload.name, place / partial
