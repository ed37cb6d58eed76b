import json
import re
import shutil
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import pytest
from bs4 import BeautifulSoup
from playwright.sync_api import Browser, expect

from renderer.viewer.page import policy_hash
from studyapp.results.report import report
from studyapp.study.folder import StudyFolder
from tests.functional.browsing import IN_A_BROWSER, SOFTWARE_GRAPHICS, launched, watched_page
from tests.studyapp.results.conftest import Answered, with_motion


@pytest.fixture(scope="module")
def folder(
    answered_once: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory
) -> StudyFolder:
    root = tmp_path_factory.mktemp("playable") / "study"
    shutil.copytree(answered_once("pairwise", people=3), root)
    return with_motion(StudyFolder(root), "ours", "theirs", "real")


@pytest.fixture(scope="module")
def path(folder: StudyFolder) -> Path:
    """Return the report in a folder without other files."""
    return Path(shutil.move(report(folder, with_motion=True), folder.root.parent))


@pytest.fixture(scope="module")
def page(path: Path) -> BeautifulSoup:
    return opened(path)


def opened(page: Path) -> BeautifulSoup:
    return BeautifulSoup(page.read_text("utf-8"), "html.parser")


def test_pairs_are_ordered_by_win_share_and_labelled(page: BeautifulSoup) -> None:
    section = page.select_one("#motion")

    assert section is not None
    captions = [each.get_text() for each in section.select(".caption")]
    shares = [float(re.findall(r": \w+ (\.?\d+)", each)[0]) for each in captions]
    assert shares
    assert shares == sorted(shares, reverse=True)
    assert len(section.select("figure.motion-viewer")) == len(captions)
    scenes = [str(each["data-scene"]) for each in section.select("figure.motion-viewer")]
    assert any("Ours (full)" in scene for scene in scenes)
    assert any("Their metrics" in each.get_text() for each in section.select("summary"))


def test_the_page_has_only_scripts_allowed_by_its_policy(page: BeautifulSoup) -> None:
    policy = str(page.select('meta[http-equiv="Content-Security-Policy"]')[0]["content"])
    run = [each.string or "" for each in page.select("script:not([type])")]

    assert len(run) == 3
    assert re.findall(r"'(sha256-[^']+)'", policy) == [policy_hash(script) for script in run]


def test_pairs_with_missing_motion_are_named(answered: Answered) -> None:
    # A mismatch study plays the pairs of its second task.
    folder = with_motion(answered("mismatch", people=3), "ours")

    section = opened(report(folder, with_motion=True)).select_one("#motion")

    assert section is not None
    assert not section.select("figure.motion-viewer")
    assert "theirs, segment" in section.get_text()
    assert "there is no motion file" in section.get_text()


def test_sound_comes_from_finished_videos_if_there_is_no_recording(answered: Answered) -> None:
    folder = with_motion(answered("pairwise", people=3), "ours", "theirs", "real")
    shutil.rmtree(folder.speech)

    page = report(folder, with_motion=True)

    viewers = opened(page).select("#motion figure.motion-viewer")
    assert viewers
    assert all('"speech": "' in str(viewer["data-scene"]) for viewer in viewers)
    skipped = json.loads(page.with_name("results.json").read_text("utf-8"))["metrics"]["skipped"]
    assert skipped == []


@pytest.mark.parametrize("browser", [pytest.param(launched, marks=IN_A_BROWSER)])
def test_a_pair_plays_in_a_self_contained_report(
    path: Path, browser: Callable[..., AbstractContextManager[Browser]]
) -> None:
    with (
        browser(*SOFTWARE_GRAPHICS) as chromium,
        watched_page(chromium, path.as_uri()) as page,
    ):
        page.goto(path.as_uri())
        pair = page.locator(".playable").first
        pair.get_by_role("button").first.click()
        expect(pair.get_by_role("slider", name="Time")).to_be_visible()
        expect(pair.locator("canvas")).to_be_visible()
        # On paper nothing can be played.
        page.emulate_media(media="print")
        expect(page.locator("#motion")).to_be_hidden()
