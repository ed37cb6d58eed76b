"""The file of a backup: a ZIP archive of the manifest and the files that it lists.

Reading trusts nothing in it: it must hold exactly these files, each with the size and SHA-256 that
the manifest states. Only their bytes are read, so none can be a link or another special file.
"""

import hashlib
import os
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Final

from pydantic import ValidationError

from motion.errors import InputError
from studyapp.custody.manifest import NAME, Manifest, OnFile, StoredFile
from studyapp.study.settings.sections import explain_errors

ENDING: Final = ".zip"
BLOCK: Final = 1 << 20
LARGEST_MANIFEST: Final = 1 << 26

COMPRESSIONS: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
VIDEO: Final = ".mp4"
"""Files that are compressed already."""

REMEDY: Final = "Use another backup: this file is damaged, was changed, or is no backup"


def write_archive(
    stream: IO[bytes], manifest: Manifest, sources: Sequence[Path], on_file: OnFile
) -> None:
    """Write the manifest and its files, which are read from `sources`, to `stream`.

    Raises
    ------
    InputError
        If a file no longer matches the manifest.
    """
    text = manifest.model_dump_json(indent=1).encode()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(_member(NAME, len(text), manifest), text)
        for done, (entry, source) in enumerate(zip(manifest.files, sources, strict=True), 1):
            member = _member(entry.path, entry.size, manifest)
            with source.open("rb") as file, archive.open(member, "w") as out:
                is_same = _copy(file, out, entry)
            if not is_same:
                raise InputError(
                    "the file changed during the backup",
                    where=source,
                    remedy="Back up again when nothing is being rendered or imported",
                )
            on_file(done, len(sources))


def read_manifest(archive: Path) -> Manifest:
    """Read only the manifest of the backup `archive`.

    Raises
    ------
    InputError
        If it is not a backup.
    """
    with _opened(archive) as members:
        return _read_manifest(members, archive)


def read_archive(
    archive: Path,
    target_of: Callable[[StoredFile], Path | None],
    on_file: OnFile,
    *,
    accept: Callable[[Manifest], None] = lambda _manifest: None,
) -> Manifest:
    """Check all of `archive`, and write its files.

    Parameters
    ----------
    target_of : callable
        Returns the new path of a file; None to only check the file.
    accept : callable
        Can raise an `InputError` before anything is written.

    Raises
    ------
    InputError
        If anything differs from the manifest. Files written until then are kept.
    """
    with _opened(archive) as members:
        manifest = _read_manifest(members, archive)
        accept(manifest)
        if sorted(members.namelist()) != sorted((NAME, *(file.path for file in manifest.files))):
            raise _unusable(archive, "it does not hold exactly the files that its manifest lists")
        for done, entry in enumerate(manifest.files, 1):
            if not _extract(members, entry, target_of(entry)):
                raise _unusable(archive, f"{entry.path} differs from what was backed up")
            on_file(done, len(manifest.files))
    return manifest


def _extract(members: zipfile.ZipFile, entry: StoredFile, target: Path | None) -> bool:
    """Write a member to `target`, if there is one; return whether it is what was backed up."""
    if members.getinfo(entry.path).compress_type not in COMPRESSIONS:
        return False
    with members.open(entry.path) as source:
        if target is None:
            return _copy(source, None, entry)
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("xb") as out:
            is_same = _copy(source, out, entry)
            out.flush()
            os.fsync(out.fileno())
            return is_same


def _copy(source: IO[bytes], out: IO[bytes] | None, entry: StoredFile) -> bool:
    """Copy `entry`, and at most one byte more; return whether it has the expected content."""
    digest, left = hashlib.sha256(), entry.size + 1
    while left and (piece := source.read(min(BLOCK, left))):
        digest.update(piece)
        left -= len(piece)
        if out is not None:
            out.write(piece)
    return digest.hexdigest() == entry.sha256


def _read_manifest(members: zipfile.ZipFile, archive: Path) -> Manifest:
    if NAME not in members.namelist() or members.getinfo(NAME).file_size > LARGEST_MANIFEST:
        raise _unusable(archive, "this is not a backup of a study")
    with members.open(NAME) as source:
        text = source.read(LARGEST_MANIFEST)
    try:
        return Manifest.model_validate_json(text)
    except ValidationError as error:
        raise _unusable(
            archive,
            f"its manifest is invalid: {explain_errors(error)}",
            remedy=f"{REMEDY}, or was made by a newer version of Motion Jury",
        ) from None


@contextmanager
def _opened(archive: Path) -> Iterator[zipfile.ZipFile]:
    try:
        with zipfile.ZipFile(archive) as members:
            yield members
    # The last two: encrypted, or with a name or number that makes no sense.
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError) as error:
        raise _unusable(archive, f"it cannot be read: {error}") from error


def _unusable(archive: Path, what: str, *, remedy: str = REMEDY) -> InputError:
    return InputError(what, where=archive, remedy=remedy)


def _member(name: str, size: int, manifest: Manifest) -> zipfile.ZipInfo:
    member = zipfile.ZipInfo(name, manifest.made_at.timetuple()[:6])
    member.file_size = size
    member.external_attr = 0o600 << 16
    member.compress_type = zipfile.ZIP_STORED if name.endswith(VIDEO) else zipfile.ZIP_DEFLATED
    return member
