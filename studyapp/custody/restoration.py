"""Restoring a study from a backup, completely or not at all."""

import shutil
import tempfile
from contextlib import closing
from pathlib import Path
from typing import Final

from motion.errors import InputError, found_at, listed
from studyapp.clock import Clock
from studyapp.custody.archive import read_archive
from studyapp.custody.backup import require_intact
from studyapp.custody.manifest import DATABASE, MEDIA, Manifest, OnFile
from studyapp.database.copies import compact, fill_from_copy, require_empty
from studyapp.database.engine import (
    Database,
    database_url_of,
    display_address,
    sqlite_file,
    sqlite_url,
)
from studyapp.database.tables.researchers import Event
from studyapp.researchers.audit import log_change
from studyapp.study.folder import StudyFolder, lock_folder, require_space
from studyapp.study.media import read_stimuli

_UNFINISHED: Final = ".unfinished-restore-"
_OWNER_ONLY: Final = frozenset({DATABASE, "pseudonyms.key", "invitations.csv"})


def restore(
    archive: Path,
    folder: StudyFolder,
    clock: Clock,
    *,
    on_file: OnFile = lambda _done, _total: None,
) -> tuple[Manifest, str]:
    """Restore the study in `archive` to `folder`, and its answers to the current database.

    Everything is first unpacked, checked and migrated to the current schema in a temporary folder,
    then moved into place. The study file is last: without it, a folder is not a study.

    Parameters
    ----------
    folder : StudyFolder
        New or empty, except for folders of media if the backup has none.

    Returns
    -------
    manifest : Manifest
        The manifest of the backup.
    database : str
        The address of the database, without a password.

    Raises
    ------
    InputError
        If the backup is damaged, or the target is not empty.
    """
    root = folder.root
    existed = root.exists()
    _require_empty_folder(root)
    root.mkdir(parents=True, exist_ok=True)
    try:
        busy = InputError(
            "another restore is running there", where=root, remedy="Wait until it ends"
        )
        with (
            lock_folder(root, busy=busy),
            tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=root) as draft,
        ):
            return _restore(archive, folder, StudyFolder(Path(draft) / "study"), clock, on_file)
    finally:
        if not existed and not any(root.iterdir()):
            root.rmdir()


def _restore(
    archive: Path,
    folder: StudyFolder,
    unpacked: StudyFolder,
    clock: Clock,
    on_file: OnFile,
) -> tuple[Manifest, str]:
    url = database_url_of(folder.root)
    require_empty(url)
    manifest = read_archive(
        archive,
        lambda entry: unpacked.root / entry.path,
        on_file,
        accept=lambda manifest: _require_room(folder.root, manifest),
    )
    copy = unpacked.root / DATABASE
    require_intact(copy, archive)
    with found_at(archive):
        if unpacked.stimuli.exists():
            read_stimuli(unpacked.stimuli)
        database = Database.open(sqlite_url(copy))
    with closing(database):
        _note_restored(database, manifest, clock)
    compact(copy)
    _move_into_place(folder, unpacked, manifest, url)
    return manifest, display_address(url)


def _note_restored(database: Database, manifest: Manifest, clock: Clock) -> None:
    detail = f"as it was on {manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
    with database.writing() as session:
        log_change(session, clock.now(), Event.RESTORED, by="", detail=detail)


def _require_empty_folder(root: Path) -> None:
    """Raise `InputError` if there is anything but folders of media at `root`."""
    if not root.exists():
        return
    if not root.is_dir():
        raise InputError("this is not a folder", where=root, remedy="Give a new or empty folder")
    existing = sorted(path.name for path in root.iterdir() if path.name not in MEDIA)
    if existing:
        raise InputError(
            f"the folder is not empty: it contains {existing[0]}",
            where=root,
            remedy="Restore to a new folder, or remove what an interrupted restore has left; only "
            f"the folders {listed(MEDIA)} may exist already",
        )


def _require_room(root: Path, manifest: Manifest) -> None:
    """Raise `InputError` unless the disk has room and no file would be overwritten."""
    # The database is written twice, the second time without deleted data.
    needed = manifest.size + sum(f.size for f in manifest.files if f.path == DATABASE)
    require_space(root, needed, work="restoring", remedy="Free up space")
    for entry in manifest.files:
        if (root / entry.path).exists():
            raise InputError(
                "the backup also contains this file",
                where=root / entry.path,
                remedy="Remove it, or restore to a new folder",
            )


def _move_into_place(
    folder: StudyFolder, unpacked: StudyFolder, manifest: Manifest, url: str
) -> None:
    """Move the unpacked files to the study; after a failure, none of them stay."""
    file = sqlite_file(url)
    targets = {
        entry.path: folder.root / entry.path
        for entry in manifest.files
        if entry.path not in (DATABASE, folder.definition.name)
    }
    if file is not None:
        targets[DATABASE] = file
    moved: list[Path] = []
    try:
        for path, target in targets.items():
            source = unpacked.root / path
            if source.name in _OWNER_ONLY:
                source.chmod(0o600)
            target.parent.mkdir(parents=True, exist_ok=True)
            moved.append(target)
            shutil.move(source, target)
        if file is None:
            fill_from_copy(url, unpacked.root / DATABASE)
        unpacked.definition.rename(folder.definition)
    except BaseException:
        for target in moved:
            target.unlink(missing_ok=True)
        raise
