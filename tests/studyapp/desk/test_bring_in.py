"""Files come into a study in the browser: who may send them, how, and what becomes of them."""

from __future__ import annotations

import io
import time
from collections.abc import Callable

import pytest

from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.desk.jobs import job_standings
from studyapp.desk.lab import Lab
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.studies.takes import write_motion

TINY = "/research/studies/tiny/"
UPLOADS = f"{TINY}uploads"
PAGE = f"{TINY}bring-in"
WHAT = {"condition": "ours", "name": "take-0.npz", "changed": "1700000000000"}
PATIENCE = 60


def send(
    browser: ResearchBrowser, piece: bytes, *, offset: int, size: int, **what: str
) -> tuple[int, dict[str, object]]:
    answer = browser.client.post(
        UPLOADS,
        query_string={**WHAT, **what, "size": str(size), "offset": str(offset)},
        data=piece,
        headers={"Form-Code": browser.code()},
    )
    return answer.status_code, answer.get_json(silent=True) or {}


@pytest.fixture
def motion(tmp_path: object, motion_file: Callable[..., object]) -> bytes:
    return write_motion(tmp_path / "motion.npz", 2.0).read_bytes()  # type: ignore[operator]


def test_pieces_come_one_after_another_and_a_wrong_one_is_told_the_place(
    lab: Lab, ada: ResearchBrowser, motion: bytes
) -> None:
    size = len(motion)
    where = {**WHAT, "size": str(size)}
    assert ada.client.get(UPLOADS, query_string=where).get_json() == {"offset": 0}
    assert send(ada, motion[:100], offset=0, size=size) == (200, {"offset": 100})
    assert send(ada, motion[:100], offset=0, size=size) == (409, {"offset": 100})
    assert ada.client.get(UPLOADS, query_string=where).get_json() == {"offset": 100}
    assert send(ada, motion[100:], offset=100, size=size) == (200, {"offset": size})
    assert (lab.folder / "tiny" / "inbox" / "ours" / "take-0.npz").read_bytes() == motion
    assert "take-0.npz" in ada.get(PAGE).text


def test_what_is_refused_says_why(ada: ResearchBrowser) -> None:
    status, told = send(ada, b"x", offset=0, size=1, name="../study.toml")
    assert status == 422
    assert "cannot be called" in str(told["problem"])
    assert send(ada, b"x", offset=0, size=10**11)[0] == 422
    assert ada.client.get(UPLOADS, query_string={"name": "a.wav"}).status_code == 400
    assert send(ada, b"x" * 2 * LARGEST_PIECE, offset=0, size=2 * LARGEST_PIECE)[0] == 413


def test_small_files_come_by_a_form_alone(lab: Lab, ada: ResearchBrowser, motion: bytes) -> None:
    def post(*names: str) -> int:
        data = {
            "form_code": ada.code(),
            "condition": "ours",
            "files": [(io.BytesIO(motion), name) for name in names],
        }
        return ada.client.post(f"{PAGE}/files", data=data).status_code

    assert post("take-0.npz", "take-1.npz") == 303
    assert post("take-2.exe") == 422
    inbox = lab.folder / "tiny" / "inbox" / "ours"
    assert sorted(path.name for path in inbox.iterdir()) == ["take-0.npz", "take-1.npz"]
    ada.post(f"{PAGE}/remove", condition="ours", name="take-0.npz")
    assert [path.name for path in inbox.iterdir()] == ["take-1.npz"]


def test_the_import_brings_in_what_it_can_and_leaves_the_rest_with_the_reason(
    lab: Lab, ada: ResearchBrowser, motion: bytes
) -> None:
    for name in ("take-0.npz", "take-9.npz"):
        assert send(ada, motion, offset=0, size=len(motion), name=name)[0] == 200
    assert ada.post(f"{TINY}jobs/import").status_code == 303
    study = lab.folder / "tiny"
    until = time.monotonic() + PATIENCE
    while job_standings(study / "jobs")["import"].is_running:
        assert time.monotonic() < until
        time.sleep(0.1)
    assert (study / "motion" / "ours" / "take-0.npz").is_file()
    assert [path.name for path in (study / "inbox" / "ours").iterdir()] == ["take-9.npz"]
    page = ada.get(PAGE)
    assert "no segment is called" in page.text
    assert "take-9.npz" in page.text
