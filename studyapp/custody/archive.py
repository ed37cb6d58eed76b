"""The file of a backup: a tar archive, possibly compressed, that starts with the manifest.

Reading trusts nothing in it: every member must be a plain file with the name, size and SHA-256 that
the manifest lists next.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import shutil
import tarfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import IO, Final, cast

from pydantic import ValidationError

from motion.errors import InputError
from studyapp.custody.manifest import NAME, Manifest, OnFile, StoredFile
from studyapp.study.settings.sections import explain_errors

ENDINGS: Final = (".tar", ".tar.gz", ".tgz")
BLOCK: Final = 1 << 20
LARGEST_MANIFEST: Final = 1 << 26
DIGEST: Final = "manifest.sha256"
LARGEST_DIGEST: Final = 1 << 10
_GZIP: Final = b"\x1f\x8b"

REMEDY: Final = "Use another backup: this file is damaged, was changed, or is no backup"


def is_compressed(name: str) -> bool:
    """Return whether a backup with this name is compressed."""
    return not name.endswith(".tar")


def write_archive(
    stream: IO[bytes],
    manifest: Manifest,
    sources: Sequence[Path],
    *,
    compressed: bool,
    on_file: OnFile,
) -> None:
    """Write the manifest and its files, which are read from `sources`, to `stream`.

    Raises
    ------
    InputError
        If a file no longer matches the manifest.
    """
    timestamp = int(manifest.made_at.timestamp())
    text = manifest.model_dump_json(indent=1).encode()
    with (
        _compress(stream, timestamp) if compressed else nullcontext(stream) as out,
        tarfile.open(fileobj=out, mode="w|", format=tarfile.PAX_FORMAT) as tar,
    ):
        for name, content in ((NAME, text), (DIGEST, _digest_line(text))):
            tar.addfile(_tar_header(name, len(content), timestamp), io.BytesIO(content))
        for done, (entry, source) in enumerate(zip(manifest.files, sources, strict=True), 1):
            _add(tar, _tar_header(entry.path, entry.size, timestamp), source, entry.sha256)
            on_file(done, len(sources))


def _add(tar: tarfile.TarFile, header: tarfile.TarInfo, source: Path, sha256: str) -> None:
    with source.open("rb") as file:
        reader = _HashingReader(file)
        try:
            tar.addfile(header, reader)
        except OSError as error:
            if error.errno is None:  # raised by tarfile: the file has shrunk
                raise _changed(source) from error
            raise
        if reader.digest != sha256 or file.read(1):
            raise _changed(source)


def read_manifest(archive: Path) -> Manifest:
    """Read only the manifest of the backup `archive`.

    Raises
    ------
    InputError
        If it is not a backup.
    """
    with _open(archive) as tar:
        return _read_manifest(tar)


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
    with _open(archive) as tar:
        manifest = _read_manifest(tar)
        accept(manifest)
        for done, entry in enumerate(manifest.files, 1):
            member = tar.next()
            if member is None:
                raise _UnusableError(f"{entry.path} is missing")
            _require_plain_file(member, entry.path, entry.size)
            if _extract(tar, member, target_of(entry)) != entry.sha256:
                raise _UnusableError(f"{entry.path} differs from what was backed up")
            on_file(done, len(manifest.files))
        if tar.next() is not None or not _at_end(tar):
            raise _UnusableError("it contains more than its manifest lists")
    return manifest


def _at_end(tar: tarfile.TarFile) -> bool:
    """Return whether only padding follows; reading it also checks the compression."""
    stream = cast(_ForwardReader, tar.fileobj)
    padding = stream.read_rest(tarfile.RECORDSIZE)
    return len(padding) <= tarfile.RECORDSIZE and not any(padding)


def _extract(tar: tarfile.TarFile, member: tarfile.TarInfo, target: Path | None) -> str:
    """Read a member, write it to `target` if there is one, and return its SHA-256."""
    source = _HashingReader(cast(IO[bytes], tar.extractfile(member)))
    if target is None:
        while source.read(BLOCK):
            pass
        return source.digest
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("xb") as out:
        shutil.copyfileobj(source, out, BLOCK)
        out.flush()
        os.fsync(out.fileno())
    return source.digest


def _read_manifest(tar: tarfile.TarFile) -> Manifest:
    text = _read_member(tar, NAME, LARGEST_MANIFEST)
    if _read_member(tar, DIGEST, LARGEST_DIGEST) != _digest_line(text):
        raise _UnusableError(f"{NAME} differs from what was written")
    try:
        return Manifest.model_validate_json(text)
    except ValidationError as error:
        raise _UnusableError(
            f"its manifest is invalid: {explain_errors(error)}",
            remedy=f"{REMEDY}, or was made by a newer version of Motion Jury",
        ) from None


def _read_member(tar: tarfile.TarFile, name: str, largest: int) -> bytes:
    """Return the content of the next member, which must be one of those that begin a backup."""
    member = tar.next()
    if member is None or member.name != name or member.size > largest:
        raise _UnusableError("this is not a backup of a study")
    _require_plain_file(member, name, member.size)
    source = cast(IO[bytes], tar.extractfile(member))
    return b"".join(iter(lambda: source.read(BLOCK), b""))


def _digest_line(text: bytes) -> bytes:
    """Return the manifest's SHA-256 as ``sha256sum`` writes it."""
    return f"{hashlib.sha256(text).hexdigest()}  {NAME}\n".encode()


def _require_plain_file(member: tarfile.TarInfo, path: str, size: int) -> None:
    """Raise an error unless `member` is the expected plain file."""
    is_plain = member.type in (tarfile.REGTYPE, tarfile.AREGTYPE) and member.sparse is None
    if not is_plain or member.name != path or member.size != size:
        raise _UnusableError(f"{path} is not the expected file")


class _UnusableError(InputError):
    """A backup cannot be used; `_open` adds which one."""

    def __init__(self, what: str, *, remedy: str = REMEDY) -> None:
        super().__init__(what, remedy=remedy)


@contextmanager
def _open(archive: Path) -> Iterator[tarfile.TarFile]:
    try:
        with archive.open("rb") as raw:
            start = raw.read(len(_GZIP))
            raw.seek(0)
            stream = gzip.GzipFile(fileobj=raw) if start == _GZIP else raw
            with tarfile.open(fileobj=cast(IO[bytes], _ForwardReader(stream)), mode="r:") as tar:
                yield tar
    except _UnusableError as error:
        raise InputError(error.what, where=archive, remedy=error.remedy) from None
    except (tarfile.TarError, EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"it cannot be read: {error}", where=archive, remedy=REMEDY) from error


class _ForwardReader:
    """Reads a file from start to end, at most `BLOCK` bytes at once.

    A header may claim that gigabytes of a name follow, which tarfile would read. And going back by
    one byte, as tarfile does to check a member, would decompress the whole file again.
    """

    def __init__(self, stream: IO[bytes] | gzip.GzipFile) -> None:
        self._stream = stream
        self._read = 0
        self._position = 0
        self._last = b""

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes."""
        if not 0 <= size <= BLOCK:
            raise tarfile.ReadError("a header is too long")
        if size == 1 and self._position == self._read - 1:
            self._position = self._read
            return self._last
        if self._position < self._read:
            raise tarfile.ReadError("its members overlap")
        while self._position > self._read:
            if not self._next(min(BLOCK, self._position - self._read)):
                return b""
        piece = self._next(size)
        self._position = self._read
        return piece

    def _next(self, size: int) -> bytes:
        piece = self._stream.read(size)
        self._read += len(piece)
        self._last = piece[-1:] or self._last
        return piece

    def read_rest(self, limit: int) -> bytes:
        """Read to the end, but at most one byte more than `limit`."""
        rest = b""
        while len(rest) <= limit and (piece := self._next(limit + 1 - len(rest))):
            rest += piece
        return rest

    def seek(self, offset: int) -> int:
        """Set the position of the next read."""
        self._position = offset
        return offset

    def tell(self) -> int:
        """Return the position of the next read."""
        return self._position


class _HashingReader(io.RawIOBase):
    """Hashes a file while it is read."""

    def __init__(self, file: IO[bytes]) -> None:
        super().__init__()
        self._file = file
        self._state = hashlib.sha256()

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes."""
        piece = self._file.read(size)
        self._state.update(piece)
        return piece

    @property
    def digest(self) -> str:
        """The SHA-256 of the bytes read so far."""
        return self._state.hexdigest()


def _compress(stream: IO[bytes], timestamp: int) -> IO[bytes]:
    file = gzip.GzipFile(filename="", mode="wb", compresslevel=6, fileobj=stream, mtime=timestamp)
    return cast(IO[bytes], file)


def _tar_header(name: str, size: int, timestamp: int) -> tarfile.TarInfo:
    header = tarfile.TarInfo(name)
    header.size, header.mtime, header.mode = size, timestamp, 0o600
    return header


def _changed(source: Path) -> InputError:
    return InputError(
        "the file changed during the backup",
        where=source,
        remedy="Back up again when nothing is being rendered or imported",
    )
