"""The file of a backup: a tar, perhaps compressed, whose first part is the manifest.

Reading one trusts nothing in it: every part must be a plain file that the manifest lists, of the
size and SHA-256 that stand there. No part is asked for by a name of its own.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import tarfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
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

REMEDY: Final = "Take another backup; this one is damaged, or was changed, or is none"


def is_compressed(name: str) -> bool:
    """Tell whether a backup of that name is compressed."""
    return not name.endswith(".tar")


def write_archive(
    stream: IO[bytes],
    manifest: Manifest,
    sources: Sequence[Path],
    *,
    compressed: bool,
    on_file: OnFile,
) -> None:
    """Write the manifest and its files, which lie at `sources`, to `stream`.

    Raises
    ------
    InputError
        If a file is no longer what the manifest says.
    """
    moment = int(manifest.made_at.timestamp())
    text = manifest.model_dump_json(indent=1).encode()
    with (
        _packed(stream, moment, compressed=compressed) as out,
        tarfile.open(fileobj=out, mode="w|", format=tarfile.PAX_FORMAT) as tar,
    ):
        for name, content in ((NAME, text), (DIGEST, _digest_line(text))):
            tar.addfile(_head(name, len(content), moment), io.BytesIO(content))
        for done, (entry, source) in enumerate(zip(manifest.files, sources, strict=True), 1):
            _add(tar, _head(entry.path, entry.size, moment), source, entry.sha256)
            on_file(done, len(sources))


def _add(tar: tarfile.TarFile, head: tarfile.TarInfo, source: Path, sha256: str) -> None:
    with source.open("rb") as file:
        reader = _Hashing(file)
        try:
            tar.addfile(head, reader)
        except OSError as error:
            if error.errno is None:  # tarfile's own: the file has become shorter
                raise _changed(source) from error
            raise
        if reader.digest != sha256 or file.read(1):
            raise _changed(source)


def read_manifest(archive: Path) -> Manifest:
    """Read what the backup `archive` says of itself, and nothing else of it.

    Raises
    ------
    InputError
        If it is not a backup.
    """
    with _opened(archive) as tar:
        return _manifest(tar, archive)


def read_archive(
    archive: Path,
    place_for: Callable[[StoredFile], Path | None],
    on_file: OnFile,
    *,
    accept: Callable[[Manifest], None] = lambda _manifest: None,
) -> Manifest:
    """Check all of `archive`, and write its files where `place_for` says.

    Parameters
    ----------
    place_for : callable
        Returns where a file goes, a path at which there is nothing, or None where it is only
        checked.
    accept : callable
        May raise an `InputError` before anything is written.

    Raises
    ------
    InputError
        If anything in it is not as the manifest says. What was written until then is left.
    """
    with _opened(archive) as tar:
        manifest = _manifest(tar, archive)
        accept(manifest)
        for done, entry in enumerate(manifest.files, 1):
            member = tar.next()
            if member is None:
                raise InputError(f"{entry.path} is missing", where=archive, remedy=REMEDY)
            _require_plain(member, entry.path, entry.size, archive)
            if _copied(tar, member, place_for(entry)) != entry.sha256:
                raise InputError(
                    f"{entry.path} is not what was backed up", where=archive, remedy=REMEDY
                )
            on_file(done, len(manifest.files))
        if tar.next() is not None or not _ends(tar):
            raise InputError("it holds more than it lists", where=archive, remedy=REMEDY)
    return manifest


def _ends(tar: tarfile.TarFile) -> bool:
    """Tell whether nothing but a tar's padding follows; what is compressed is then whole too."""
    stream = cast(_Forward, tar.fileobj)
    padding = stream.rest(tarfile.RECORDSIZE)
    return len(padding) <= tarfile.RECORDSIZE and not any(padding)


def _copied(tar: tarfile.TarFile, member: tarfile.TarInfo, place: Path | None) -> str:
    """Read a part, write it to `place` if there is one, and return its SHA-256."""
    state = hashlib.sha256()
    source = cast(IO[bytes], tar.extractfile(member))
    if place is None:
        while piece := source.read(BLOCK):
            state.update(piece)
        return state.hexdigest()
    place.parent.mkdir(parents=True, exist_ok=True)
    with place.open("xb") as out:
        while piece := source.read(BLOCK):
            state.update(piece)
            out.write(piece)
        out.flush()
        os.fsync(out.fileno())
    return state.hexdigest()


def _manifest(tar: tarfile.TarFile, archive: Path) -> Manifest:
    member = tar.next()
    if member is None or member.name != NAME or member.size > LARGEST_MANIFEST:
        raise InputError("this is not a backup of a study", where=archive, remedy=REMEDY)
    text = _text(tar, member, NAME, archive)
    digest = tar.next()
    if digest is None or digest.size > LARGEST_DIGEST:
        raise InputError("this is not a backup of a study", where=archive, remedy=REMEDY)
    if _text(tar, digest, DIGEST, archive) != _digest_line(text):
        raise InputError(f"{NAME} is not what was written", where=archive, remedy=REMEDY)
    try:
        return Manifest.model_validate_json(text)
    except ValidationError as error:
        raise InputError(
            f"what it says of itself is wrong: {explain_errors(error)}",
            where=archive,
            remedy=f"{REMEDY}; or a newer version of Motion Jury made it",
        ) from None


def _text(tar: tarfile.TarFile, member: tarfile.TarInfo, name: str, archive: Path) -> bytes:
    _require_plain(member, name, member.size, archive)
    source = cast(IO[bytes], tar.extractfile(member))
    return b"".join(iter(lambda: source.read(BLOCK), b""))


def _digest_line(text: bytes) -> bytes:
    """Return the manifest's SHA-256 as ``sha256sum`` writes it."""
    return f"{hashlib.sha256(text).hexdigest()}  {NAME}\n".encode()


def _require_plain(member: tarfile.TarInfo, path: str, size: int, archive: Path) -> None:
    """Raise `InputError` unless a part is the plain file that is expected next."""
    is_plain = member.type in (tarfile.REGTYPE, tarfile.AREGTYPE) and member.sparse is None
    if not is_plain or member.name != path or member.size != size:
        raise InputError(f"{path} is not what it should be", where=archive, remedy=REMEDY)


@contextmanager
def _opened(archive: Path) -> Iterator[tarfile.TarFile]:
    try:
        with archive.open("rb") as raw:
            start = raw.read(len(_GZIP))
            raw.seek(0)
            stream = gzip.GzipFile(fileobj=raw) if start == _GZIP else raw
            with tarfile.open(fileobj=cast(IO[bytes], _Forward(stream)), mode="r:") as tar:
                yield tar
    except (tarfile.TarError, EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"it cannot be read: {error}", where=archive, remedy=REMEDY) from error


class _Forward:
    """A file that is read from its start to its end, never more than `BLOCK` bytes at once.

    A header may claim to be followed by gigabytes of a name, which would all be read. And to go
    back by one byte, as tarfile does to see whether a part is whole, would unpack all of a
    compressed file again.
    """

    def __init__(self, stream: IO[bytes] | gzip.GzipFile) -> None:
        self._stream = stream
        self._read = 0
        self._wanted = 0
        self._last = b""

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes."""
        if not 0 <= size <= BLOCK:
            raise tarfile.ReadError("a header is too long")
        if size == 1 and self._wanted == self._read - 1:
            self._wanted = self._read
            return self._last
        if self._wanted < self._read:
            raise tarfile.ReadError("its parts overlap")
        while self._wanted > self._read:
            if not self._next(min(BLOCK, self._wanted - self._read)):
                return b""
        piece = self._next(size)
        self._wanted = self._read
        return piece

    def _next(self, size: int) -> bytes:
        piece = self._stream.read(size)
        self._read += len(piece)
        self._last = piece[-1:] or self._last
        return piece

    def rest(self, most: int) -> bytes:
        """Read what follows to the end; a byte more than `most` where there is more."""
        found = b""
        while len(found) <= most and (piece := self._next(most + 1 - len(found))):
            found += piece
        return found

    def seek(self, offset: int) -> int:
        """Say where to read next."""
        self._wanted = offset
        return offset

    def tell(self) -> int:
        """Return where is read next."""
        return self._wanted


class _Hashing(io.RawIOBase):
    """A file that is hashed while it is read."""

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
        """SHA-256 of what was read."""
        return self._state.hexdigest()


@contextmanager
def _packed(stream: IO[bytes], moment: int, *, compressed: bool) -> Iterator[IO[bytes]]:
    if not compressed:
        yield stream
        return
    with gzip.GzipFile(
        filename="", mode="wb", compresslevel=6, fileobj=stream, mtime=moment
    ) as out:
        yield cast(IO[bytes], out)


def _head(name: str, size: int, moment: int) -> tarfile.TarInfo:
    head = tarfile.TarInfo(name)
    head.size, head.mtime, head.mode = size, moment, 0o600
    return head


def _changed(source: Path) -> InputError:
    return InputError(
        "the file changed while it was backed up",
        where=source,
        remedy="Back up again when nothing is being rendered or brought in",
    )
