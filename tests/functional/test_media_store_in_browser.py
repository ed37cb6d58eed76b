"""A participant's browser loads the videos from a store, under the pages' strict policy."""

from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from studyapp.stimuli.publishing import publish
from studyapp.study.folder import StudyFolder
from studyapp.web.media_store import Place
from tests.functional.browsing import IN_A_BROWSER, PATIENCE_MS, serving
from tests.functional.taking_part import begin_study, expect_trial, take_trial, watch
from tests.support.servers.s3_stand_in import BUCKET, s3_stand_in, use_keys

pytestmark = IN_A_BROWSER


def test_videos_play_and_preload_from_a_store_that_learns_no_page_and_without_it_from_the_server(
    browser: Browser, tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = browser.new_page()
    page.set_default_timeout(PATIENCE_MS)
    complaints: list[str] = []
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    answers: list[str] = []
    page.on("response", lambda r: answers.append(f"{r.status} {r.url.split('/')[3]}"))
    use_keys(monkeypatch)
    with ExitStack() as storing:
        store = storing.enter_context(s3_stand_in())
        place = Place(bucket=BUCKET, folder="my-study/", endpoint=store.endpoint)
        publish(StudyFolder(tiny_study), place, lambda _done, _total: None)
        with serving(tiny_study, "--media-store") as address:
            store.origins = [address]
            store.asked.clear()
            begin_study(page, address)
            for number in (1, 2):
                expect_trial(page, number)
                watch(page)
                expect(page.locator("#ahead")).to_contain_text("next page ready")
                take_trial(page, number)
            expect_trial(page, 3)

            assert complaints == []
            assert "302 media" in answers
            own_copies = {"200 media", "206 media"}
            assert not own_copies & set(answers)
            asked = store.gets()
            assert len({path.partition("?")[0] for path, _ in asked}) == 3
            for path, headers in asked:
                assert "X-Amz-Signature=" in path
                sent = {name.lower(): value for name, value in headers.items()}
                assert sent["origin"] == address
                assert not {"cookie", "referer", "authorization"} & set(sent)

            storing.close()
            store.objects.clear()  # a connection that the browser keeps is still answered
            for number in (3, 4):
                take_trial(page, number)
            expect_trial(page, 5)
            watch(page)
            expect(page.locator(".fault")).to_be_hidden()
            assert own_copies & set(answers)
