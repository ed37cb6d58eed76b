"""Uploads go on where they stopped, stay in the inbox, and leave the disk some room."""

from __future__ import annotations

import threading
from collections import namedtuple
from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.desk.inbox import KEPT_FREE, Inbox, InboxFile, Upload, WrongOffsetError
from studyapp.study.folder import StudyFolder

CONTENT = bytes(range(256)) * 40


def upload(**changes: object) -> Upload:
    stated: dict[str, object] = {
        "name": "take.wav",
        "size": len(CONTENT),
        "changed": 1_700_000_000_000,
    }
    return Upload.model_validate(stated | changes)


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    (tmp_path / "study").mkdir()
    return StudyFolder(tmp_path / "study")


@pytest.fixture
def inbox(folder: StudyFolder) -> Inbox:
    return Inbox(folder, largest=100_000)


def files(folder: StudyFolder) -> list[str]:
    found = folder.root.rglob("*")
    return sorted(path.relative_to(folder.root).as_posix() for path in found if path.is_file())


def test_pieces_become_the_file(inbox: Inbox, folder: StudyFolder) -> None:
    file = upload()
    assert inbox.received(file) == 0
    for start in range(0, len(CONTENT), 3000):
        assert inbox.append(file, start, CONTENT[start : start + 3000]) == min(
            start + 3000, len(CONTENT)
        )
    assert files(folder) == ["inbox/take.wav"]
    assert (folder.inbox / "take.wav").read_bytes() == CONTENT
    assert inbox.received(file) == len(CONTENT)


def test_an_upload_goes_on_where_it_stopped_even_after_a_crash(folder: StudyFolder) -> None:
    Inbox(folder).append(upload(condition="ours", name="take.npz"), 0, CONTENT[:5000])
    again = Inbox(folder)
    (partial,) = (folder.inbox / "ours").iterdir()
    # The server died while it wrote a piece.
    with partial.open("ab") as file:
        file.write(CONTENT[5000:5100])
    wanted = upload(condition="ours", name="take.npz")
    assert again.received(wanted) == 5100
    assert again.files() == [
        InboxFile(condition="ours", name="take.npz", received=5100, size=len(CONTENT))
    ]
    again.append(wanted, 5100, CONTENT[5100:])
    assert (folder.inbox / "ours" / "take.npz").read_bytes() == CONTENT


def test_a_file_that_was_changed_begins_anew(inbox: Inbox, folder: StudyFolder) -> None:
    inbox.append(upload(), 0, CONTENT[:5000])
    assert inbox.received(upload(changed=1_700_000_000_001)) == 0
    assert inbox.received(upload(size=9999)) == 0


@pytest.mark.parametrize("offset", [0, 4999, 5001])
def test_a_piece_at_another_place_is_refused_with_the_right_one(inbox: Inbox, offset: int) -> None:
    inbox.append(upload(), 0, CONTENT[:5000])
    with pytest.raises(WrongOffsetError) as refused:
        inbox.append(upload(), offset, CONTENT[offset : offset + 100])
    assert refused.value.offset == 5000
    assert inbox.received(upload()) == 5000


def test_a_piece_that_comes_twice_at_once_is_stored_once(inbox: Inbox, folder: StudyFolder) -> None:
    inbox.append(upload(), 0, CONTENT[:2000])
    done: list[str] = []

    def send() -> None:
        try:
            inbox.append(upload(), 2000, CONTENT[2000:])
            done.append("stored")
        except (WrongOffsetError, InputError):
            done.append("refused")

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert done.count("stored") == 1
    assert (folder.inbox / "take.wav").read_bytes() == CONTENT


@pytest.mark.parametrize("piece", [b"", CONTENT + b"!"])
def test_nothing_and_more_than_the_rest_are_refused(inbox: Inbox, piece: bytes) -> None:
    with pytest.raises(InputError, match="bytes came of"):
        inbox.append(upload(), 0, piece)
    assert inbox.received(upload()) == 0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        *(
            ({"name": name}, "cannot be called")
            for name in ("../take.wav", ".hidden.wav", "a\\b.wav", "a\0.wav", "b" * 200 + ".wav")
        ),
        *(
            ({"name": name}, "neither speech, motion nor a video")
            for name in ("run.py", "take.pkl", "take.wav.exe")
        ),
        *(
            ({"condition": condition}, "not a usable condition name")
            for condition in ("..", "../../elsewhere", "/etc")
        ),
        ({"size": 0}, "is empty"),
        ({"size": 100_001}, "is too large"),
    ],
)
def test_what_can_never_be_brought_in_is_refused_at_once(
    inbox: Inbox, folder: StudyFolder, changes: dict[str, object], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        inbox.received(upload(**changes))
    with pytest.raises(InputError, match=said):
        inbox.append(upload(**changes), 0, b"x")
    assert files(folder) == []


def test_another_file_of_a_name_never_takes_the_place_of_one(inbox: Inbox) -> None:
    inbox.append(upload(), 0, CONTENT)
    other = upload(changed=1_800_000_000_000)
    with pytest.raises(InputError, match=r"another take\.wav is here already"):
        inbox.append(other, 0, CONTENT)
    inbox.remove("", "take.wav")
    assert inbox.append(other, 0, CONTENT) == len(CONTENT)


def test_the_disk_keeps_room_for_answers(inbox: Inbox, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = namedtuple("usage", "total used free")
    free = KEPT_FREE + len(CONTENT) - 1
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage(free, 0, free))
    with pytest.raises(InputError, match=r"no room for take\.wav"):
        inbox.append(upload(), 0, CONTENT[:10])
    assert inbox.received(upload()) == 0


def test_whole_and_partial_files_are_removed(inbox: Inbox, folder: StudyFolder) -> None:
    inbox.append(upload(), 0, CONTENT[:10])
    inbox.append(upload(changed=5), 0, CONTENT[:10])
    inbox.append(upload(name="other.wav"), 0, CONTENT)
    inbox.remove("", "take.wav")
    assert files(folder) == ["inbox/other.wav"]
    with pytest.raises(InputError):
        inbox.remove("", "../study.toml")
