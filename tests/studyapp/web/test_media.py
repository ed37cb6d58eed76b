"""Videos from this server, through a proxy, or from a store: exact bytes, and nothing revealing."""

import shutil
import socket
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from flask import Flask
from sqlalchemy import select
from werkzeug.test import TestResponse

from motion.errors import InputError
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Video
from studyapp.session.served_study import ServedStudy
from studyapp.stimuli.publishing import MARK_BYTES, publish
from studyapp.study.folder import StudyFolder
from studyapp.study.media import read_stimuli, write_stimuli
from studyapp.web.media_store import FILE, SIGNED_SECONDS, Bucket, MediaStore, Place
from studyapp.web.site import attach, site_of
from studyapp.web.worker import StudyWorker
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.visitor import Visitor, stored_in
from tests.support.servers.s3_stand_in import BUCKET, KEY, Store, forget_keys, s3_stand_in, use_keys
from tests.support.studies.added_condition import make_videos_anew
from tests.support.studies.taking_part_steps import SetClock


@pytest.fixture
def address(app: Flask, clock: SetClock) -> str:
    """Return the address of a participant's current video."""
    Visitor(app, clock).enrol().begin().page()
    token = stored_in(app, select(Video.token).order_by(Video.id))[0]
    return f"/media/{token}.mp4"


def content(app: Flask, address: str) -> bytes:
    sent: bytes = app.test_client().get(address, buffered=True).data
    return sent


@pytest.mark.parametrize(
    ("headers", "status", "part"),
    [
        ({"Range": "bytes=0-"}, 206, slice(None)),
        ({"Range": "bytes=10-19"}, 206, slice(10, 20)),
        ({"Range": "bytes=-5"}, 206, slice(-5, None)),
        ({"If-Range": '"x"', "Range": "bytes=1-2"}, 200, slice(None)),
        ({"Range": "nonsense"}, 200, slice(None)),
    ],
)
def test_a_byte_range_is_exact_and_an_unsatisfiable_one_gets_everything_or_an_error(
    app: Flask, address: str, headers: dict[str, str], status: int, part: slice
) -> None:
    whole = content(app, address)

    answer = app.test_client().get(address, headers=headers, buffered=True)

    assert (answer.status_code, answer.data) == (status, whole[part])
    assert answer.headers["Content-Length"] == str(len(whole[part]))
    first, stop, _ = part.indices(len(whole))
    sent = f"bytes {first}-{stop - 1}/{len(whole)}" if status == 206 else None
    assert answer.headers.get("Content-Range") == sent
    beyond = app.test_client().get(address, headers={"Range": f"bytes={len(whole)}-"})
    assert beyond.status_code == 416 and beyond.data != whole


def test_a_request_for_the_headers_alone_sends_no_video(app: Flask, address: str) -> None:
    head = app.test_client().head(address, buffered=True)

    assert not any(stored_in(app, select(Video.sent_at)))
    assert (head.data, int(head.headers["Content-Length"])) == (b"", len(content(app, address)))
    assert any(stored_in(app, select(Video.sent_at)))


def test_a_proxy_gets_the_files_path_instead_of_its_bytes(
    app: Flask, address: str, tiny_study: Path
) -> None:
    whole = content(app, address)
    attach(app, replace(site_of(app), accel_prefix="/study files/"))

    answer = app.test_client().get(address, headers={"Range": "bytes=0-"})

    assert (answer.status_code, answer.data, answer.mimetype) == (200, b"", "video/mp4")
    inner = answer.headers["X-Accel-Redirect"]
    assert (tiny_study / inner.removeprefix("/study%20files/")).read_bytes() == whole


def test_a_worker_logs_nothing_of_a_failed_request() -> None:
    class Log:
        said = ""

        def error(self, words: str, *values: object) -> None:
            self.said += words % values

    worker = StudyWorker.__new__(StudyWorker)
    worker.log = Log()
    failure = RuntimeError("/take/secret")
    ours, theirs = socket.socketpair()
    with ours, theirs:
        try:
            raise failure
        except RuntimeError as error:
            worker.handle_error(None, ours, ("203.0.113.9", 1), error)
        answer = theirs.recv(1000)

    assert answer.startswith(b"HTTP/1.1 500")
    assert "RuntimeError" in worker.log.said
    assert "secret" not in worker.log.said


def test_videos_replaced_while_serving_are_not_shown(
    app: Flask, address: str, clock: SetClock, tiny_study: Path
) -> None:
    before = read_stimuli(tiny_study / "stimuli.json")
    make_videos_anew(tiny_study)

    (token,) = stored_in(app, select(StudySession.token))
    requested = (address, "/", f"/take/{token}")
    for each in requested:
        answer = app.test_client().get(each)
        assert answer.status_code == 409
        assert "has just been changed" in answer.text

    write_stimuli(tiny_study / "stimuli.json", before)
    for each in requested:
        assert app.test_client().get(each, buffered=True).status_code == 200
    (tiny_study / "stimuli.json").unlink()
    assert app.test_client().get("/").status_code == 200


@pytest.fixture(scope="module")
def published(
    tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Path, Store]]:
    """Return a study whose videos are in a store, and that store; tests copy the study."""
    folder = tmp_path_factory.mktemp("published") / "study"
    shutil.copytree(tiny_study_template, folder)
    with pytest.MonkeyPatch.context() as patch, s3_stand_in() as store:
        use_keys(patch)
        place = Place(bucket=BUCKET, folder="my-study/", endpoint=store.endpoint)
        publish(StudyFolder(folder), place, lambda _done, _total: None)
        yield folder, store


@pytest.fixture
def store(published: tuple[Path, Store]) -> Store:
    """Return the store that holds the study's videos."""
    _, store = published
    store.asked.clear()
    return store


@pytest.fixture
def study(published: tuple[Path, Store], tmp_path: Path) -> Path:
    """Return a copy of the folder of the published study."""
    return Path(shutil.copytree(published[0], tmp_path / "published"))


@pytest.fixture
def from_store(study: Path, store: Store, serve: Serve) -> Flask:
    """Return the application of a study whose videos are in the store."""
    served = ServedStudy.read(study)
    return serve(folder=study, served=served, store=MediaStore.of(study, served))


def redirects(app: Flask, clock: SetClock) -> list[TestResponse]:
    """Take the study to its end, and return the response for each video, in order."""
    visitor = Visitor(app, clock).enrol().begin()
    responses = []
    for page in visitor.take_trials():
        for video in page.soup.select("video"):
            responses.append(visitor.client.get(str(video["src"])))
            # Reloading a video does not change its address.
            again = visitor.client.get(f"{video['src']}?again=1").location
            assert urlsplit(again).path == urlsplit(responses[-1].location).path
    return responses


def test_repeated_trials_look_like_new_ones(from_store: Flask, clock: SetClock) -> None:
    served = site_of(from_store).served
    known = {video.file.read_bytes() for video in served.videos.values()}
    shown_again = 0
    # Of four participants, some see the practice video again, others its mirrored pair.
    for _ in range(4):
        answers = redirects(from_store, clock)
        require_alike(answers)
        loaded = [httpx.get(answer.location) for answer in answers]

        contents = [each.content[:-MARK_BYTES] for each in loaded]
        assert set(contents) <= known
        shown_again += len(contents) - len(set(contents))
        for contents_or_names in (
            [urlsplit(answer.location).path for answer in answers],
            [each.headers["ETag"] for each in loaded],
            [each.content for each in loaded],
        ):
            assert len(set(contents_or_names)) == len(contents_or_names)
    assert shown_again > 0


def require_alike(answers: list[TestResponse]) -> None:
    """Require that addresses differ only in name, time and signature, and headers not at all."""
    parts = [urlsplit(answer.location) for answer in answers]
    assert len({(each.netloc, len(each.path), len(each.query)) for each in parts}) == 1
    for each in parts:
        query = parse_qs(each.query)
        signed_fields = {"X-Amz-Date", "X-Amz-Signature"}
        assert {name: query[name] for name in query.keys() - signed_fields} == {
            "X-Amz-Algorithm": ["AWS4-HMAC-SHA256"],
            "X-Amz-Credential": [f"{KEY}/{query['X-Amz-Date'][0][:8]}/here-1/s3/aws4_request"],
            "X-Amz-Expires": [str(SIGNED_SECONDS)],
            "X-Amz-SignedHeaders": ["host"],
        }
    headers = [
        {name: value for name, value in answer.headers if name != "Location"} for answer in answers
    ]
    assert all(sent == headers[0] for sent in headers)
    assert headers[0]["Referrer-Policy"] == "no-referrer"
    assert headers[0]["Cache-Control"] == "private, max-age=300"
    assert "Set-Cookie" not in headers[0]


def test_this_server_sends_a_video_whose_address_cannot_be_signed(
    from_store: Flask, clock: SetClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(bucket: Bucket, name: str, seconds: int) -> str:
        raise InputError("the keys have expired")

    page = Visitor(from_store, clock).enrol().begin().page()
    monkeypatch.setattr(Bucket, "address", fail)

    answer = from_store.test_client().get(page.value("video", "src"), buffered=True)

    assert (answer.status_code, answer.mimetype) == (200, "video/mp4")


def test_pages_may_load_media_only_from_the_store(
    from_store: Flask, app: Flask, clock: SetClock, store: Store
) -> None:
    policies = []
    for each in (from_store, app):
        visitor = Visitor(each, clock).enrol().begin()
        policies.append(visitor.client.get(visitor.address).headers["Content-Security-Policy"])
    inside = from_store.test_client().get("/research/login").headers["Content-Security-Policy"]

    assert f"media-src 'self' {store.endpoint}; " in policies[0]
    assert f"connect-src 'self' {store.endpoint}; " in policies[0]
    assert policies[0].replace(f" {store.endpoint}", "") == policies[1]
    assert store.endpoint not in inside


def test_copies_missing_from_the_store_are_reported_before_serving(
    study: Path, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    served = ServedStudy.read(study)
    forget_keys(monkeypatch)
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    with pytest.raises(InputError, match=r"sign an address .*AWS_ACCESS_KEY_ID"):
        MediaStore.of(study, served)
    with (study / "videos" / "pairs" / "003.mp4").open("ab") as video:
        video.write(b"\0\0\0\x08free")
    with pytest.raises(InputError, match=r"003\.mp4: the video is not in the store as it is here"):
        MediaStore.of(study, served)
    (study / FILE).unlink()
    with pytest.raises(InputError, match="the videos were not published"):
        MediaStore.of(study, served)
