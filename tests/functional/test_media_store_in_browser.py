"""A participant's browser loads the videos from a store, under the pages' strict policy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from studyapp.stimuli.publishing import publish
from studyapp.study.folder import StudyFolder
from studyapp.web.media_store import Place
from tests.functional.browsing import (
    IN_A_BROWSER,
    PATIENCE_MS,
    begin_study,
    expect_trial,
    launched,
    serving,
)
from tests.support.servers.s3_stand_in import BUCKET, Store, s3_stand_in, use_keys

pytestmark = IN_A_BROWSER


@contextmanager
def published(study: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    """Publish the study's videos in a store, which answers until the block ends."""
    use_keys(monkeypatch)
    with s3_stand_in() as store:
        place = Place(bucket=BUCKET, folder="my-study/", endpoint=store.endpoint)
        publish(StudyFolder(study), place, lambda _done, _total: None)
        yield store


def test_videos_play_and_are_fetched_ahead_and_nothing_of_the_page_reaches_the_store(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (
        published(tiny_study, monkeypatch) as store,
        serving(tiny_study, "--media-store") as address,
        launched() as chromium,
    ):
        store.origins = [address]
        store.asked.clear()
        page = chromium.new_page()
        page.set_default_timeout(PATIENCE_MS)
        complaints: list[str] = []
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        answers: list[str] = []
        page.on("response", lambda r: answers.append(f"{r.status} {r.url.split('/')[3]}"))

        take_trials(page, address, 2)

        assert complaints == []
        assert "302 media" in answers
        assert "200 media" not in answers
        assert "206 media" not in answers
        check_asked(store, address)


def test_where_the_store_is_down_a_video_plays_from_the_study_s_own_server(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with published(tiny_study, monkeypatch):
        pass
    with serving(tiny_study, "--media-store") as address, launched() as chromium:
        page = chromium.new_page()
        page.set_default_timeout(PATIENCE_MS)
        begin_study(page, address)
        watch(page)
        expect(page.locator(".fault")).to_be_hidden()


def take_trials(page: Page, address: str, count: int) -> None:
    begin_study(page, address)
    for number in range(1, count + 1):
        expect_trial(page, number)
        watch(page)
        expect(page.locator("#ahead")).to_contain_text("next page ready")
        for name in ("rhythm", "emotion"):
            page.locator(f"input[name={name}]").first.check()
        page.get_by_role("button", name="Next").click()
    expect_trial(page, count + 1)


def watch(page: Page) -> None:
    """Play the video until all of it counts as watched: a busy machine leaves pictures out."""
    watched = page.locator("#watched")
    for _ in range(8):
        page.get_by_role("button", name="Play both").click()
        try:
            expect(watched).to_have_text("Watched ✓", timeout=10_000)
        except AssertionError:
            continue
        return
    expect(watched).to_have_text("Watched ✓")


def check_asked(store: Store, address: str) -> None:
    """Check that the store was asked for videos by signed addresses, and told of no page."""
    asked = store.gets()
    assert len({path.partition("?")[0] for path, _ in asked}) == 3
    for path, headers in asked:
        assert "X-Amz-Signature=" in path
        sent = {name.lower(): value for name, value in headers.items()}
        assert sent["origin"] == address
        assert not {"cookie", "referer", "authorization"} & set(sent)
