"""Backups are read without trust."""

from __future__ import annotations

import gzip
import hashlib
import io
import tarfile
import tracemalloc
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pydantic import ValidationError

from motion.errors import InputError
from studyapp.custody.archive import (
    DIGEST,
    LARGEST_MANIFEST,
    is_compressed,
    read_archive,
    read_manifest,
    write_archive,
)
from studyapp.custody.manifest import NAME, Manifest, StoredFile

FILES = {
    "study.toml": b"name = 'tiny'\n",
    "speech/segments.csv": b"x" * 512,
    "videos/pairs/" + "ü" * 60 + "/000.mp4": bytes(range(256)) * 5000,
    "responses.db": bytes(4096 * 3),
}


def entry(path: str, content: bytes) -> StoredFile:
    return StoredFile(path=path, size=len(content), sha256=hashlib.sha256(content).hexdigest())


def manifest_of(files: dict[str, bytes]) -> Manifest:
    return Manifest(
        motionjury="0.1.0",
        made_at=datetime(2026, 5, 4, 12, tzinfo=UTC),
        origin="somewhere",
        schema_name="0001",
        rows={"responses": 2},
        files=tuple(entry(path, content) for path, content in files.items()),
    )


def silent(_done: int, _total: int) -> None:
    """Show nothing."""


def listing(manifest: bytes) -> list[tuple[tarfile.TarInfo | str, bytes]]:
    """Return the first two parts of a backup."""
    digest = hashlib.sha256(manifest).hexdigest()
    return [(NAME, manifest), (DIGEST, f"{digest}  {NAME}\n".encode())]


def forge(archive: Path, *members: tuple[tarfile.TarInfo | str, bytes]) -> Path:
    """Write an archive of any given parts."""
    with tarfile.open(archive, "w") as tar:
        for head, content in members:
            info = tarfile.TarInfo(head) if isinstance(head, str) else head
            if info.isreg():
                info.size = len(content)
            tar.addfile(info, io.BytesIO(content))
    return archive


def as_json(manifest: Manifest) -> bytes:
    return manifest.model_dump_json().encode()


def unpack(archive: Path, into: Path) -> Manifest:
    return read_archive(archive, lambda file: into / file.path, silent)


@pytest.mark.parametrize("name", ["out.tar", "out.tar.gz"])
def test_every_flipped_or_missing_byte_is_detected(name: str, tmp_path: Path) -> None:
    archive, broken = tmp_path / name, tmp_path / "broken"
    manifest, sources = manifest_of(FILES), [tmp_path / f"{number}" for number in range(len(FILES))]
    for source, content in zip(sources, FILES.values(), strict=True):
        source.write_bytes(content)
    with archive.open("wb") as stream:
        compressed = is_compressed(name)
        write_archive(stream, manifest, sources, compressed=compressed, on_file=silent)
    assert read_manifest(archive) == unpack(archive, tmp_path / "unpacked") == manifest
    whole = archive.read_bytes()
    contents = [whole.index(content[:64]) for content in FILES.values() if content[:64] in whole]
    facts = [whole.index(word) for word in (b'"0.1.0"', b"2026-", b"somewhere") if word in whole]
    # A compressed file ends with a check sum and its length, eight bytes.
    flipped = [*facts, *contents] or [len(whole) // 3, len(whole) - 8, len(whole) - 4]
    for damaged in (
        *(whole[:index] + bytes([whole[index] ^ 1]) + whole[index + 1 :] for index in flipped),
        *(whole[: max(0, n)] for n in (0, 1, 511, 513, len(whole) // 2, len(whole) - 11_000)),
    ):
        broken.write_bytes(damaged)
        with pytest.raises(InputError, match="Use another backup"):
            read_archive(broken, lambda _: None, silent)


def test_a_file_that_changes_during_the_backup_is_named(tmp_path: Path) -> None:
    for grown in (b"name = 'tiny'\n#", b"name", b"NAME = 'tiny'\n"):
        (tmp_path / "study.toml").write_bytes(grown)
        (tmp_path / "responses.db").write_bytes(b"")
        manifest = manifest_of({"study.toml": FILES["study.toml"], "responses.db": b""})
        sources = [tmp_path / "study.toml", tmp_path / "responses.db"]
        with pytest.raises(InputError, match=r"study\.toml: the file changed"):
            write_archive(io.BytesIO(), manifest, sources, compressed=False, on_file=silent)


@pytest.mark.parametrize(
    "path",
    [
        "../study.toml",
        "/etc/passwd",
        "videos/../../x",
        "videos//x",
        "videos/./x",
        "videos",
        "videos/",
        "study.toml/x",
        ".bashrc",
        "report/index.html",
        "videos/a\0b",
        "",
    ],
)
def test_paths_outside_the_study_are_refused(path: str) -> None:
    with pytest.raises(ValidationError, match="not a file of a study"):
        entry(path, b"")


BASE = {"study.toml": b"name", "responses.db": b"rows"}


def special_file(kind: bytes) -> tarfile.TarInfo:
    head = tarfile.TarInfo("study.toml")
    head.type, head.linkname, head.size = kind, "/etc/passwd", len(BASE["study.toml"])
    return head


SPECIAL = (tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.CHRTYPE, tarfile.FIFOTYPE, tarfile.DIRTYPE)


@pytest.mark.parametrize(
    ("parts", "error"),
    [
        *(
            ([(special_file(kind), b"name")], "study.toml is not the expected file")
            for kind in SPECIAL
        ),
        ([("../x", b"name")], "study.toml is not the expected file"),
        ([("study.toml", b"name and more")], "study.toml is not the expected file"),
        ([("study.toml", b"eman")], "study.toml differs from what was backed up"),
        ([("study.toml", b"name")], "responses.db is missing"),
        (
            [("responses.db", b"rows"), ("study.toml", b"name")],
            "study.toml is not the expected file",
        ),
        ([*BASE.items(), ("videos/x", b"")], "more than its manifest lists"),
    ],
)
def test_every_member_must_match_the_manifest(
    parts: list[tuple[tarfile.TarInfo | str, bytes]], error: str, tmp_path: Path
) -> None:
    archive = forge(tmp_path / "out.tar", *listing(as_json(manifest_of(BASE))), *parts)

    with pytest.raises(InputError, match=error):
        unpack(archive, tmp_path / "unpacked")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"format":1', b'"format":2'),
        (b"responses.db", b"study.toml"),
        (b"motionjury backup", b"holiday pictures"),
        (b'"format"', b"\xff\xfe"),
    ],
)
def test_an_invalid_manifest_is_refused(old: bytes, new: bytes, tmp_path: Path) -> None:
    text = as_json(manifest_of(BASE)).replace(old, new)
    archive = forge(tmp_path / "out.tar", *listing(text), *BASE.items())

    with pytest.raises(InputError, match="its manifest is invalid"):
        read_manifest(archive)


@pytest.mark.parametrize("members", [(), [("holiday.jpg", b"")]])
def test_other_archives_are_refused(members: Sequence[tuple[str, bytes]], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="this is not a backup"):
        read_manifest(forge(tmp_path / "out.tar", *members))


def test_a_false_size_does_not_exhaust_memory(tmp_path: Path) -> None:
    """Small headers can claim long names and manifests, which compress to nothing."""
    long_name = tarfile.TarInfo(NAME)
    long_name.type, long_name.size = tarfile.GNUTYPE_LONGNAME, 1 << 30
    manifest = tarfile.TarInfo(NAME)
    manifest.size = LARGEST_MANIFEST + 1
    for number, head in enumerate((long_name, manifest)):
        archive = tmp_path / f"{number}.tar.gz"
        with gzip.open(archive, "wb", compresslevel=1) as out:
            out.write(head.tobuf(tarfile.GNU_FORMAT))
            out.write(bytes(1 << 24))
        tracemalloc.start()
        try:
            with pytest.raises(InputError):
                read_manifest(archive)
            assert tracemalloc.get_traced_memory()[1] < 8 << 20
        finally:
            tracemalloc.stop()
