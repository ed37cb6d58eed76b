"""Backups are read without trust."""

import hashlib
import io
import tracemalloc
import zipfile
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pydantic import ValidationError

from motion.errors import InputError
from studyapp.custody.archive import LARGEST_MANIFEST, read_archive, read_manifest, write_archive
from studyapp.custody.manifest import NAME, Manifest, StoredFile

FILES = {
    "study.toml": b"name = 'tiny'\n",
    "speech/segments.csv": b"x" * 512,
    "videos/pairs/" + "ü" * 60 + "/000.mp4": bytes(range(256)) * 5000,
    "responses.db": bytes(4096 * 3),
}

Member = tuple[zipfile.ZipInfo | str, bytes]


def entry(path: str, content: bytes) -> StoredFile:
    return StoredFile(path=path, size=len(content), sha256=hashlib.sha256(content).hexdigest())


def manifest_of(files: dict[str, bytes]) -> Manifest:
    return Manifest(
        motionjury="0.1.0",
        made_at=datetime(2026, 5, 4, 12, tzinfo=UTC),
        origin="somewhere",
        rows={"responses": 2},
        files=tuple(entry(path, content) for path, content in files.items()),
    )


def silent(_done: int, _total: int) -> None:
    """Show nothing."""


def forge(archive: Path, *members: Member) -> Path:
    """Write an archive of any given parts."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as out:
        for head, content in members:
            out.writestr(head, content)
    return archive


def unpack(archive: Path, into: Path) -> Manifest:
    return read_archive(archive, lambda file: into / file.path, silent)


def written(into: Path) -> tuple[bytes, Manifest]:
    """Return a whole backup of `FILES`, and its manifest."""
    manifest, sources = manifest_of(FILES), [into / f"{number}" for number in range(len(FILES))]
    for source, content in zip(sources, FILES.values(), strict=True):
        source.write_bytes(content)
    stream = io.BytesIO()
    write_archive(stream, manifest, sources, silent)
    return stream.getvalue(), manifest


def test_every_changed_or_missing_content_is_detected(tmp_path: Path) -> None:
    archive, broken = tmp_path / "out.zip", tmp_path / "broken.zip"
    whole, manifest = written(tmp_path)
    archive.write_bytes(whole)
    assert read_manifest(archive) == unpack(archive, tmp_path / "unpacked") == manifest
    with zipfile.ZipFile(archive) as members:
        assert [member.compress_type for member in members.infolist()] == [8, 8, 8, 0, 8]
        middles = [
            # Before the content stand a header of 30 bytes and the name.
            member.header_offset + 30 + len(member.filename.encode()) + member.compress_size // 2
            for member in members.infolist()
        ]
    check_sum = whole.rindex(b"PK\x01\x02") + 16
    for damaged in (
        *(whole[:at] + bytes([whole[at] ^ 255]) + whole[at + 1 :] for at in (*middles, check_sum)),
        *(whole[:size] for size in (0, 1, 511, len(whole) // 2, len(whole) - 1)),
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
            write_archive(io.BytesIO(), manifest, sources, silent)


@pytest.mark.parametrize(
    "path",
    [
        *("../study.toml", "/etc/passwd", "videos/../../x", "videos//x", "videos/./x", "videos"),
        *("videos/", "study.toml/x", ".bashrc", "report/index.html", "videos/a\0b", ""),
    ],
)
def test_paths_outside_the_study_are_refused(path: str) -> None:
    with pytest.raises(ValidationError, match="not a file of a study"):
        entry(path, b"")


BASE = {"study.toml": b"name", "responses.db": b"rows"}
ROWS = ("responses.db", b"rows")
MANIFEST = (NAME, manifest_of(BASE).model_dump_json().encode())


def by_bzip2() -> zipfile.ZipInfo:
    head = zipfile.ZipInfo("study.toml")
    head.compress_type = zipfile.ZIP_BZIP2
    return head


def changed(old: bytes, new: bytes) -> Member:
    return NAME, MANIFEST[1].replace(old, new)


@pytest.mark.parametrize(
    ("members", "error"),
    [
        ([], "this is not a backup"),
        ([("holiday.jpg", b"")], "this is not a backup"),
        ([changed(b'"format":1', b'"format":2'), *BASE.items()], "its manifest is invalid"),
        ([changed(b"responses.db", b"study.toml"), *BASE.items()], "its manifest is invalid"),
        ([changed(b"motionjury backup", b"pictures"), *BASE.items()], "its manifest is invalid"),
        ([changed(b'"format"', b"\xff\xfe"), *BASE.items()], "its manifest is invalid"),
        ([MANIFEST, ("../x", b"name"), ROWS], "exactly the files"),
        ([MANIFEST, ROWS], "exactly the files"),
        ([MANIFEST, *BASE.items(), ("videos/x", b"")], "exactly the files"),
        ([MANIFEST, *BASE.items(), ("videos/", b"")], "exactly the files"),
        ([MANIFEST, *BASE.items(), ROWS], "exactly the files"),
        ([MANIFEST, ("study.toml", b"name and more"), ROWS], "study.toml differs from what was"),
        ([MANIFEST, ("study.toml", b"eman"), ROWS], "study.toml differs from what was"),
        ([MANIFEST, (by_bzip2(), b"name"), ROWS], "study.toml differs from what was"),
    ],
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_archives_that_are_no_backups_or_differ_from_their_manifest_are_refused(
    members: list[Member], error: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=error):
        unpack(forge(tmp_path / "out.zip", *members), tmp_path / "unpacked")


def test_a_link_is_restored_as_a_file(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("study.toml")
    link.external_attr = 0o120777 << 16

    unpack(forge(tmp_path / "out.zip", MANIFEST, (link, b"name"), ROWS), tmp_path / "unpacked")

    restored = tmp_path / "unpacked" / "study.toml"
    assert not restored.is_symlink() and restored.read_bytes() == b"name"


def test_a_false_size_does_not_exhaust_memory_or_disk(tmp_path: Path) -> None:
    """What compresses to nothing may be as large as the manifest states, and no larger."""
    large = forge(tmp_path / "0.zip", (NAME, bytes(LARGEST_MANIFEST + 1)))
    bomb = forge(tmp_path / "1.zip", MANIFEST, ("study.toml", bytes(1 << 26)), ROWS)
    tracemalloc.start()
    try:
        for archive in (large, bomb):
            with pytest.raises(InputError):
                unpack(archive, tmp_path / "unpacked")
        assert tracemalloc.get_traced_memory()[1] < 8 << 20
    finally:
        tracemalloc.stop()
    assert (tmp_path / "unpacked" / "study.toml").stat().st_size == len(BASE["study.toml"]) + 1
