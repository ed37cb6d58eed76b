"""Bringing a study back from a backup, whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.errors import InputError, found_at, listed
from studyapp.clock import Clock
from studyapp.custody.archive import read_archive
from studyapp.custody.backup import require_sound
from studyapp.custody.manifest import DATABASE, MEDIA, Manifest, OnFile, media_amiss
from studyapp.database.copies import compact, fill_from_copy, require_empty
from studyapp.database.engine import (
    Database,
    database_url_of,
    display_address,
    sqlite_file,
    sqlite_url,
)
from studyapp.database.tables import Event
from studyapp.researchers.audit import log_change
from studyapp.stimuli.disk_space import as_text
from studyapp.study.folder import StudyFolder, lock_folder
from studyapp.study.media import read_stimuli

_UNFINISHED: Final = ".unfinished-restore-"
_FOR_THE_OWNER: Final = frozenset({DATABASE, "pseudonyms.key", "invitations.csv"})


@dataclass(frozen=True, kw_only=True)
class Restored:
    """A study that was brought back.

    Attributes
    ----------
    manifest : Manifest
        What the backup says of itself.
    database : str
        The address of its answers, without a password.
    missing, other : tuple of str
        Media that the study had and that are not there, or not as they were.
    """

    manifest: Manifest
    database: str
    missing: tuple[str, ...]
    other: tuple[str, ...]


def restore(
    archive: Path,
    folder: StudyFolder,
    clock: Clock,
    *,
    on_file: OnFile = lambda _done, _total: None,
) -> Restored:
    """Bring the study in `archive` back to `folder`, and its answers to the database of now.

    Everything is unpacked, checked and brought to the newest schema apart. Then it takes its
    place, the study file last: without it, no command takes a folder for a study.

    Parameters
    ----------
    folder : StudyFolder
        Empty or not there; the folders of its media may be there, where the backup has none.
    on_file : callable
        Is told how many files are done, of how many.

    Raises
    ------
    InputError
        If the backup is not whole, or there is something already where the study is to go.
    """
    root = folder.root
    existed = root.exists()
    _require_free(root)
    root.mkdir(parents=True, exist_ok=True)
    try:
        busy = InputError("another restore is at work there", where=root, remedy="Wait for its end")
        with (
            lock_folder(root, busy=busy),
            tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=root) as draft,
        ):
            return _restored(archive, folder, StudyFolder(Path(draft) / "study"), clock, on_file)
    finally:
        if not existed and not any(root.iterdir()):
            root.rmdir()


def _restored(
    archive: Path,
    folder: StudyFolder,
    unpacked: StudyFolder,
    clock: Clock,
    on_file: OnFile,
) -> Restored:
    url = database_url_of(folder.root)
    require_empty(url)
    manifest = read_archive(
        archive,
        lambda entry: unpacked.root / entry.path,
        on_file,
        accept=lambda found: _require_fits(folder.root, found),
    )
    copy = unpacked.root / DATABASE
    require_sound(copy, manifest, archive)
    with found_at(archive):
        if unpacked.stimuli.exists():
            read_stimuli(unpacked.stimuli)
        database = Database.open(sqlite_url(copy))
    with closing(database):
        _note_restored(database, manifest, clock)
    compact(copy)
    _take_place(folder, unpacked, manifest, url)
    missing, other = media_amiss(folder.root, manifest.media)
    return Restored(
        manifest=manifest,
        database=display_address(url),
        missing=tuple(missing),
        other=tuple(other),
    )


def _note_restored(database: Database, manifest: Manifest, clock: Clock) -> None:
    detail = f"as it was on {manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
    with database.writing() as session:
        log_change(session, clock.now(), Event.RESTORED, by="", detail=detail)


def _require_free(root: Path) -> None:
    """Raise `InputError` unless there is nothing at `root` but folders of media."""
    if not root.exists():
        return
    if not root.is_dir():
        raise InputError("this is not a folder", where=root, remedy="Give a new or empty folder")
    there = sorted(path.name for path in root.iterdir() if path.name not in MEDIA)
    if any(name.startswith(_UNFINISHED) for name in there):
        raise InputError(
            f"a restore did not come to its end here, and left {listed(there)}",
            where=root,
            remedy="Remove these, and restore again",
        )
    if there:
        raise InputError(
            f"the folder is not empty: {there[0]} is there",
            where=root,
            remedy="Restore into a new folder, so that nothing that is there can be lost; only "
            f"the folders {listed(MEDIA)} may be there before",
        )


def _require_fits(root: Path, manifest: Manifest) -> None:
    """Raise `InputError` unless there is room, and no file where one is to go."""
    # The database is written a second time, without what was deleted.
    needed = manifest.size + sum(f.size for f in manifest.files if f.path == DATABASE)
    free = shutil.disk_usage(root).free
    if needed > free:
        raise InputError(
            f"{as_text(needed)} are needed, and {as_text(free)} are free",
            where=root,
            remedy="Make room",
        )
    for entry in manifest.files:
        if (root / entry.path).exists():
            raise InputError(
                "the backup has this file too",
                where=root / entry.path,
                remedy="Remove it, or restore into a new folder",
            )


def _take_place(folder: StudyFolder, unpacked: StudyFolder, manifest: Manifest, url: str) -> None:
    """Move what was unpacked to where it belongs; where that fails, nothing of it stays."""
    file = sqlite_file(url)
    places = {
        entry.path: folder.root / entry.path
        for entry in manifest.files
        if entry.path not in (DATABASE, folder.definition.name)
    }
    if file is not None:
        places[DATABASE] = file
    moved: list[Path] = []
    try:
        for path, place in places.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            moved.append(place)
            shutil.move(_kept_close(unpacked.root / path), place)
        if file is None:
            fill_from_copy(url, unpacked.root / DATABASE)
        unpacked.definition.rename(folder.definition)
    except BaseException:
        for place in moved:
            place.unlink(missing_ok=True)
        raise


def _kept_close(file: Path) -> Path:
    """Let only the owner read `file` where it is nobody else's business."""
    if file.name in _FOR_THE_OWNER and file.exists():
        file.chmod(0o600)
    return file
