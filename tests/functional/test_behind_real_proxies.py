"""A study session through the proxies, as `motionjury deploy` sets them up."""

import os
import re
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urljoin, urlsplit

import httpx
import pytest

from studyapp.custody.deployment import PROXIES, Proxy
from studyapp.web.worker import REQUEST_SECONDS
from tests.functional.proxies import HOST, PATIENCE, Proxied, any_certificate, behind, program
from tests.studyapp.web.page_reader import PageReader
from tests.support.hanging_connections import hanging, slow_body, whole_video
from tests.support.researcher_accounts import PASSWORD
from tests.support.servers.http_participant import HttpParticipant

pytestmark = pytest.mark.slow

PREFIX = "/studies/one"
VIDEO_BYTES = 4 << 20
"""More than the buffers of lines and proxies hold."""

PAGES = 3
"""Consent, instructions and a trial."""


@pytest.fixture(params=PROXIES, scope="module")
def proxied(
    request: pytest.FixtureRequest,
    tiny_study_template: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Proxied]:
    proxy: Proxy = request.param
    if program(proxy) is None:
        pytest.skip(f"{proxy}, or openssl, is not installed")
    root = tmp_path_factory.mktemp(proxy)
    # A folder's name may hold what means something in the files of a proxy.
    study = root / "50% {x};# of it" / "my-study"
    shutil.copytree(tiny_study_template, study)
    for video in study.glob("videos/**/*.mp4"):
        os.truncate(video, VIDEO_BYTES)
    with behind(proxy, study, root, prefix=PREFIX) as served:
        yield served


def test_a_participant_answers_and_the_proxy_reveals_and_logs_nothing(proxied: Proxied) -> None:
    with proxied.client() as client:
        participant = HttpParticipant(client, proxied.address, pages=PAGES)
        page = client.get(participant.address)
        video = participant.video
        whole = client.get(video)
        part = client.get(video, headers={"Range": "bytes=100-199"})
        unchanged = client.get(video, headers={"If-Modified-Since": whole.headers["date"]})
        beyond = client.get(video, headers={"Range": f"bytes={len(whole.content)}-"})

    assert participant.page.soup.select("#answers")
    assert (page.headers["cache-control"], page.headers["referrer-policy"]) == (
        "no-store",
        "no-referrer",
    )
    assert "set-cookie" not in page.headers
    assert page.headers["strict-transport-security"] == "max-age=31536000"
    assert part.content == whole.content[100:200]
    assert part.headers["content-range"] == f"bytes 100-199/{len(whole.content)}"
    assert (unchanged.status_code, beyond.status_code) == (200, 416)
    for answer in (whole, part):
        assert answer.headers["content-type"] == "video/mp4"
        assert answer.headers["x-content-type-options"] == "nosniff"
        names = {name.lower() for name in answer.headers}
        assert not {"etag", "last-modified", "set-cookie", "x-accel-redirect"} & names
        assert "videos" not in str(answer.headers)
    assert participant.tokens
    assert not [token for token in participant.tokens if token in proxied.written()]


def test_files_and_other_paths_are_out_of_reach(proxied: Proxied) -> None:
    with proxied.client() as client:
        address = proxied.address.removesuffix(f"{PREFIX}/")
        inside = proxied.deployment.inner_location
        for path in (
            f"{inside}/videos/pairs/000.mp4",
            f"{inside}/study.toml",
            f"{inside}/videos/../responses.db",
            f"{PREFIX}{inside}/videos/pairs/000.mp4",
            "/",
            "/research/",
            f"{PREFIX}2/",
        ):
            assert client.get(f"{address}{path}").status_code == 404, path
        missing_slash = client.get(f"{address}{PREFIX}?PROLIFIC_PID=p%261", follow_redirects=True)
        assert PageReader(missing_slash.text).action.startswith(f"{PREFIX}/")
        forged = {"Script_Name": "/evil", "SCRIPT_NAME": "/evil", "X-Forwarded-Prefix": "/evil"}
        assert "/evil" not in client.get(proxied.address, headers=forged).text


def test_researchers_cookies_are_limited_to_https_and_their_path(proxied: Proxied) -> None:
    log = (proxied.root / "study.log").read_text("utf-8")
    link = re.search(r"https://\S+/join/\S+", log)
    assert link is not None
    with proxied.client() as client:
        # Headers that visitors send themselves are ignored.
        lies = {"X-Forwarded-For": "6.6.6.6", "X-Forwarded-Proto": "http"}
        join = PageReader(client.get(link[0], headers=lies).text)
        code = join.value("main [name=form_code]", "value")
        fields = {"name": "Ada", "password": PASSWORD, "again": PASSWORD, "form_code": code}
        joined = client.post(urljoin(link[0], join.action), data=fields, headers=lies)
        assert joined.headers["location"] == f"{PREFIX}/research/"
        cookie = joined.headers["set-cookie"]
        assert "Secure" in cookie
        assert f"Path={PREFIX}/research" in cookie
        overview = client.get(urljoin(link[0], joined.headers["location"]))
        assert "Progress" in overview.text
        assert overview.headers["x-frame-options"] == "DENY"
    assert link[0].rpartition("/")[2] not in proxied.written()


def test_a_participant_answers_while_300_connections_of_another_address_hang(
    proxied: Proxied,
) -> None:
    tls = any_certificate()
    with proxied.client() as client:
        other = HttpParticipant(client, proxied.address, pages=PAGES)
        video = whole_video(urlsplit(other.video).path, HOST)
        slow = slow_body(f"{PREFIX}/", HOST)
        with (
            hanging(proxied.port, slow, 300, trickle=b"x", tls=tls, host=HOST),
            hanging(proxied.port, video, 100, tls=tls, host=HOST),
        ):
            # Less than after which the lines are ended.
            client.timeout = httpx.Timeout(REQUEST_SECONDS - 5)
            participant = HttpParticipant(client, proxied.address, pages=PAGES + 2)

    assert participant.page.soup.select("#answers")


def test_while_the_study_is_down_no_address_is_logged(proxied: Proxied) -> None:
    with proxied.client() as client:
        participant = HttpParticipant(client, proxied.address, pages=1)
        proxied.server.send_signal(signal.SIGINT)
        proxied.server.wait(timeout=PATIENCE)

        away = client.get(participant.address)

    assert away.status_code in (502, 503)
    assert not [token for token in participant.tokens if token in proxied.written()]
