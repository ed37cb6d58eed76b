"""Backing up a study into one file, even while it is served, and checking backups."""

import hashlib
import os
import re
import tempfile
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.custody.archive import (
    ENDING,
    REMEDY,
    read_archive,
    read_manifest,
    write_archive,
)
from studyapp.custody.manifest import (
    DATABASE,
    Manifest,
    OnFile,
    media_files,
    small_files,
    stored_file,
)
from studyapp.database.copies import count_rows, find_flaws, write_copy
from studyapp.database.engine import database_url_of, display_address
from studyapp.study.folder import StudyFolder

_UNFINISHED: Final = ".unfinished-backup-"


@dataclass(frozen=True, kw_only=True)
class Backup:
    """A finished backup.

    Attributes
    ----------
    path : Path
        Its file.
    manifest : Manifest
        Its contents.
    database : str
        The address of the database, without a password.
    removed : tuple of Path
        Older backups that were removed.
    """

    path: Path
    manifest: Manifest
    database: str
    removed: tuple[Path, ...] = ()


def back_up(
    folder: StudyFolder,
    out: Path,
    clock: Clock,
    *,
    media: bool = False,
    keep: int | None = None,
    on_file: OnFile = lambda _done, _total: None,
) -> Backup:
    """Back up the study in `folder` and its database into one file.

    The file appears under its name only once it is complete, checked and on disk, and only its
    owner can read it. It contains every answer that was acknowledged before the call.

    Parameters
    ----------
    out : Path
        The file, which must not exist; or a folder, where the file is named after the study and
        the time.
    media : bool
        Include speech, motion and videos.
    keep : int, optional
        With a folder: the number of this study's backups to keep.

    Raises
    ------
    InputError
        If there is no database, `out` cannot be written, or a file changes meanwhile.
    """
    into_folder = out.is_dir()
    if not into_folder:
        _require_new_file(out)
    if keep is not None and not into_folder:
        raise InputError(
            "older backups can only be removed from a folder",
            where=out,
            remedy="Give an existing folder with --keep",
        )
    made_at = clock.now()
    url = database_url_of(folder.root)
    # On the disk of the backup, and private.
    disk = out if into_folder else out.parent
    with tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=disk) as name:
        work = Path(name)
        copy = work / DATABASE
        write_copy(url, copy)
        included = [*small_files(folder), (copy, stored_file(copy, DATABASE))]
        if media:
            included += media_files(folder, on_file)
        manifest = Manifest(
            motionjury=metadata.version("motionjury"),
            made_at=made_at,
            origin=_origin(folder, url),
            rows=count_rows(copy),
            files=tuple(entry for _, entry in included),
        )
        study = folder.root.resolve().name
        path = out / f"{study}-{made_at:{_TIMESTAMP}}{ENDING}" if into_folder else out
        draft = work / "archive"
        handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "wb") as stream:
            write_archive(stream, manifest, [source for source, _ in included], on_file)
            stream.flush()
            os.fsync(stream.fileno())
        check_archive(draft, on_file)
        _publish(draft, path)
    removed = () if keep is None else _remove_older(path, study, manifest, keep)
    return Backup(path=path, manifest=manifest, database=display_address(url), removed=removed)


def _require_new_file(out: Path) -> None:
    if out.suffix != ENDING:
        raise InputError(
            f"a backup is a {ENDING}",
            where=out,
            remedy="Give such a name, or an existing folder",
        )
    if out.exists() or out.is_symlink():
        raise _exists_already(out)
    if not out.parent.is_dir():
        # Creating it could fill a disk on which another one should have been mounted.
        raise InputError(
            "the folder for the backup does not exist",
            where=out.parent,
            remedy="Create it, or mount its disk",
        )


def _publish(draft: Path, path: Path) -> None:
    """Rename the finished `draft` to `path`, unless that exists, and sync the folder."""
    try:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600))
    except FileExistsError:
        raise _exists_already(path) from None
    draft.replace(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _exists_already(path: Path) -> InputError:
    return InputError(
        "this file exists, and backups never overwrite",
        where=path,
        remedy="Give another name, or a folder, where each backup gets its own name",
    )


def _origin(folder: StudyFolder, url: str) -> str:
    location = f"{folder.root.resolve()}\n{display_address(url)}"
    return hashlib.sha256(location.encode()).hexdigest()


_TIMESTAMP: Final = "%Y%m%dT%H%M%SZ"
_TIMESTAMP_PATTERN: Final = r"\d{8}T\d{6}Z"


def _remove_older(newest: Path, study: str, manifest: Manifest, keep: int) -> tuple[Path, ...]:
    """Remove all but the `keep` newest backups beside `newest`, and return the removed.

    Other files, other studies' backups, and backups with names of another form are kept.
    """
    pattern = re.compile(rf"{re.escape(study)}-{_TIMESTAMP_PATTERN}\{ENDING}")
    backups = sorted(
        (
            path
            for path in newest.parent.iterdir()
            if pattern.fullmatch(path.name)
            and not path.is_symlink()
            and path.is_file()
            and _origin_of_archive(path) == manifest.origin
        ),
        # A name ends with the time. One of the future comes from a clock that was wrong.
        key=lambda path: (path.name <= newest.name, path.name),
        reverse=True,
    )
    for path in backups[keep:]:
        path.unlink()
    return tuple(backups[keep:])


def _origin_of_archive(path: Path) -> str | None:
    try:
        return read_manifest(path).origin
    except InputError:
        return None


def check_archive(archive: Path, on_file: OnFile) -> None:
    """Check the files of a backup and its database.

    Raises
    ------
    InputError
        If anything differs from what was backed up.
    """
    with tempfile.TemporaryDirectory(prefix="motionjury-") as name:
        copy = Path(name) / DATABASE
        read_archive(archive, lambda entry: copy if entry.path == DATABASE else None, on_file)
        require_intact(copy, archive)


def require_intact(copy: Path, archive: Path) -> None:
    """Raise `InputError` unless the database `copy` of `archive` is an intact study's."""
    if flaws := find_flaws(copy):
        raise InputError(
            f"its database cannot be used: {'; '.join(flaws[:3])}",
            where=archive,
            remedy=REMEDY,
        )
