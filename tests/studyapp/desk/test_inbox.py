"""Uploads resume, stay in the inbox, and leave free disk space."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier
from types import SimpleNamespace

import pytest

from motion.errors import InputError
from studyapp.desk.inbox import KEPT_FREE, LARGEST_PIECE, Inbox, InboxFile, Upload
from studyapp.study.folder import StudyFolder
from tests.studyapp.web.research.research_browser import ResearchBrowser

CONTENT = bytes(range(256)) * 40


def upload(**changes: object) -> Upload:
    stated = {"name": "take.wav", "size": len(CONTENT), "changed": 1_700_000_000_000}
    return Upload.model_validate(stated | changes)


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    (tmp_path / "study").mkdir()
    return StudyFolder(tmp_path / "study")


@pytest.fixture
def inbox(folder: StudyFolder) -> Inbox:
    return Inbox(folder)


def received(inbox: Inbox, file: Upload) -> int:
    """Return where the next piece of a file begins."""
    return inbox.append(file, -1, b"")


def files(folder: StudyFolder) -> list[str]:
    paths = folder.root.rglob("*")
    return sorted(path.relative_to(folder.root).as_posix() for path in paths if path.is_file())


def test_an_upload_resumes_even_after_a_crash(folder: StudyFolder) -> None:
    file = upload(condition="ours", name="take.npz")
    Inbox(folder).append(file, 0, CONTENT[:5000])
    again = Inbox(folder)
    (partial,) = (folder.inbox / "ours").iterdir()
    # The server died while it wrote a piece.
    with partial.open("ab") as written:
        written.write(CONTENT[5000:5100])
    # Another file was moved away while the page is made.
    (folder.inbox / "ours" / ".gone.npz.9.5.part").symlink_to("nowhere")
    assert again.files() == [
        InboxFile(condition="ours", name="take.npz", received=5100, size=len(CONTENT))
    ]
    # A changed file starts again.
    for changed in ({"changed": 1_700_000_000_001}, {"size": 9999}):
        assert received(again, upload(condition="ours", name="take.npz", **changed)) == 0
    assert received(again, file) == 5100
    again.append(file, 5100, CONTENT[5100:])
    assert files(folder) == ["inbox/ours/take.npz"]
    assert (folder.inbox / "ours" / "take.npz").read_bytes() == CONTENT


def test_a_chunk_with_a_wrong_offset_or_size_is_refused(inbox: Inbox) -> None:
    inbox.append(upload(), 0, CONTENT[:5000])
    for offset in (0, 4999, 5001):
        assert inbox.append(upload(), offset, CONTENT[offset : offset + 100]) == 5000
    for piece in (b"", CONTENT[5000:] + b"!"):
        with pytest.raises(InputError, match="bytes came of"):
            inbox.append(upload(), 5000, piece)
    assert received(inbox, upload()) == 5000


def test_a_chunk_sent_twice_at_once_is_stored_once(
    inbox: Inbox, folder: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    inbox.append(upload(), 0, CONTENT[:2000])
    # All have found that their piece comes next, and write only then.
    asked = Barrier(8)

    def wait_for_all(_path: Path) -> SimpleNamespace:
        asked.wait(60)
        return SimpleNamespace(free=2 * KEPT_FREE)

    monkeypatch.setattr("shutil.disk_usage", wait_for_all)

    def store_piece(_number: int) -> int:
        return inbox.append(upload(), 2000, CONTENT[2000:])

    with ThreadPoolExecutor(8) as pool:
        assert len(CONTENT) in list(pool.map(store_piece, range(8)))
    assert (folder.inbox / "take.wav").read_bytes() == CONTENT


@pytest.mark.parametrize(
    ("field", "values", "message"),
    [
        ("name", ("../take.wav", ".hidden.wav", "a\\b.wav", "a\0.wav", ""), "usable file name"),
        # Importing would refuse them as names of segments.
        ("name", ("take 1.wav", "_take.wav", f"{'b' * 101}.wav", "a@b@c.mp4"), "usable file name"),
        ("name", ("run.py", "take.pkl", "take.wav.exe"), "neither speech, motion nor a video"),
        ("condition", ("..", "../../elsewhere", "/etc"), "not a usable condition name"),
        ("size", (0,), "bytes came of"),
    ],
)
def test_files_that_can_never_be_imported_are_refused_at_once(
    inbox: Inbox, folder: StudyFolder, field: str, values: tuple[object, ...], message: str
) -> None:
    for value in values:
        with pytest.raises(InputError, match=message):
            inbox.append(upload(**{field: value}), 0, b"x")
    assert files(folder) == []


def test_a_video_may_name_two_segments_of_the_longest_names(
    inbox: Inbox, folder: StudyFolder
) -> None:
    name = f"{'a' * 100}@{'b' * 100}.mp4"
    assert inbox.append(upload(name=name), 0, CONTENT[:10]) == 10
    assert [(file.name, file.received) for file in inbox.files()] == [(name, 10)]
    assert inbox.append(upload(name=name), 10, CONTENT[10:]) == len(CONTENT)
    assert files(folder) == [f"inbox/{name}"]


def test_a_file_must_be_removed_before_another_takes_its_name(
    inbox: Inbox, folder: StudyFolder
) -> None:
    inbox.append(upload(name="other.wav"), 0, CONTENT)
    inbox.append(upload(changed=5), 0, CONTENT[:10])
    inbox.append(upload(), 0, CONTENT)
    other = upload(changed=1_800_000_000_000)
    with pytest.raises(InputError, match=r"another take\.wav is here already"):
        inbox.append(other, 0, CONTENT)
    inbox.remove("", "take.wav")
    assert files(folder) == ["inbox/other.wav"]
    with pytest.raises(InputError):
        inbox.remove("", "../study.toml")
    assert inbox.append(other, 0, CONTENT) == len(CONTENT)


def test_uploads_leave_disk_space_for_answers(
    inbox: Inbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    free = SimpleNamespace(free=KEPT_FREE + len(CONTENT) - 1)
    monkeypatch.setattr("shutil.disk_usage", lambda _: free)
    with pytest.raises(InputError, match=r"no room for take\.wav"):
        inbox.append(upload(), 0, CONTENT[:10])
    assert received(inbox, upload()) == 0


TINY = "/research/studies/tiny/"
UPLOADS = f"{TINY}uploads"
WHAT = {"condition": "ours", "name": "take-0.npz", "changed": "1700000000000"}


def send_piece(
    browser: ResearchBrowser, piece: bytes, *, offset: int, size: int, **what: str
) -> tuple[int, dict[str, object]]:
    answer = browser.client.post(
        UPLOADS,
        query_string={**WHAT, **what, "size": str(size), "offset": str(offset)},
        data=piece,
        headers={"Form-Code": browser.code()},
    )
    return answer.status_code, answer.get_json(silent=True) or {}


def test_refusals_give_a_reason_or_where_to_go_on(ada: ResearchBrowser) -> None:
    for _ in range(2):
        status_and_offset = send_piece(ada, b"first", offset=0, size=9)
    assert status_and_offset == (200, {"offset": 5})
    status, answer = send_piece(ada, b"x", offset=0, size=1, name="../study.toml")
    assert status == 422
    assert "not a usable file name" in str(answer["problem"])
    assert send_piece(ada, b"x", offset=0, size=10**15)[0] == 422
    assert send_piece(ada, b"x", offset=0, size=0)[0] == 422
    assert send_piece(ada, b"x", offset=-1, size=1)[0] == 400
    assert send_piece(ada, b"x" * 2 * LARGEST_PIECE, offset=0, size=2 * LARGEST_PIECE)[0] == 413
