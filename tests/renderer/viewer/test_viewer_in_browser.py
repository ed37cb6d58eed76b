import io
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page, expect

from motion.arrays import Bools
from motion.body.model import BodyModel
from motion.clip import MotionClip
from renderer.clip_video import Stage, still
from renderer.framing import frame_clips
from renderer.look import BACKGROUND, Look, default_body
from renderer.shown_clip import as_shown
from renderer.viewer.page import Scene, write_motion_page, write_shared_files
from tests.functional.browsing import (
    IN_A_BROWSER,
    SOFTWARE_GRAPHICS,
    launched,
    wait_until,
    watched_page,
)
from tests.functional.page_checks import SCHEMES, barriers, photograph
from tests.support.sounds import tone

pytestmark = IN_A_BROWSER

FULL_BODY = Look(framing="full_body")
COUNTED_DRAWINGS = """() => {
  const draw = WebGL2RenderingContext.prototype.drawElements;
  window.drawings = 0;
  WebGL2RenderingContext.prototype.drawElements = function (...given) {
    window.drawings += 1;
    return draw.apply(this, given);
  };
}"""
SECOND = 0.6
"""Where the pictures are compared."""


@pytest.fixture(scope="module")
def shown(clip: MotionClip, body: BodyModel) -> MotionClip:
    return as_shown(clip, body, Path("clip.npz"), clip.duration, (), 30)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched(*SOFTWARE_GRAPHICS) as chromium:
        yield chromium


def opened(page: Page, path: Path, **clips: MotionClip) -> None:
    """Open a page that shows clips of one length with a tone as their speech."""
    (first, *_) = clips.values()
    speech = tone(first.duration, 230, 48_000, 0.1)
    write_motion_page(path, "Motion", [Scene(name="it", clips=clips, speech=speech)], FULL_BODY)
    page.goto(path.as_uri())
    expect(page.get_by_role("button", name="Play")).to_be_visible()


def seconds(page: Page) -> float:
    return float(page.locator("figure").get_attribute("data-seconds") or "nan")


def scrub(page: Page, wanted: float) -> NDArray[np.uint8]:
    """Go to a moment, and return the picture, shape (height, width, 3)."""
    page.get_by_role("slider", name="Time").fill(f"{wanted:g}")
    wait_until(page, lambda: abs(seconds(page) - wanted) < 0.01)
    return picture(page)


def picture(page: Page) -> NDArray[np.uint8]:
    page.wait_for_timeout(300)
    shot = page.locator("canvas").screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))


def body_in(image: NDArray[np.uint8]) -> Bools:
    """Return the mask of a body in the upper three quarters of a picture, above the ground."""
    upper = image[: len(image) * 3 // 4].astype(int)
    return np.asarray(np.abs(upper - BACKGROUND).max(axis=2) > 40)


def halves(image: NDArray[np.uint8]) -> tuple[Bools, Bools]:
    """Return the masks of the bodies in the left and the right half of a picture."""
    half = image.shape[1] // 2
    return body_in(image[:, :half]), body_in(image[:, half : 2 * half])


def shared(first: Bools, second: Bools) -> float:
    """Return how much of what either picture shows both show, from 0 to 1."""
    return float((first & second).sum() / (first | second).sum())


def test_the_viewer_shows_the_videos_frame_and_rotates_it(
    browser: Browser, shown: MotionClip, body: BodyModel, tmp_path: Path
) -> None:
    with watched_page(browser, tmp_path.as_uri()) as page:
        opened(page, tmp_path / "page.html", ours=shown)
        page.locator(".labels").evaluate("labels => labels.remove()")
        seen = scrub(page, SECOND)

        height, width = seen.shape[:2]
        look = Look(framing="full_body", size=height // 2 * 2)
        with Stage(default_body(), frame_clips([shown], body, look), look) as stage:
            true = np.asarray(still(stage, shown, SECOND))
        left = (width - true.shape[1]) // 2
        square = seen[: len(true), left : left + true.shape[1]]
        assert shared(body_in(square), body_in(true)) > 0.95
        head = slice(len(true) // 12, len(true) // 7)
        assert np.abs(square[head].mean(axis=(0, 1)) - true[head].mean(axis=(0, 1))).max() < 6

        earlier = scrub(page, 0.1)
        assert shared(body_in(earlier), body_in(seen)) < 0.99
        scrub(page, SECOND)
        page.get_by_role("slider", name="Turn").fill("90")
        assert shared(body_in(picture(page)), body_in(seen)) < 0.7
        page.get_by_role("button", name="From the front").click()
        assert shared(body_in(picture(page)), body_in(seen)) > 0.99
        box = page.locator("canvas").bounding_box()
        assert box is not None
        page.mouse.move(box["x"] + 300, box["y"] + 200)
        page.mouse.down()
        page.mouse.move(box["x"] + 500, box["y"] + 200, steps=4)
        page.mouse.up()
        assert shared(body_in(picture(page)), body_in(seen)) < 0.8
        page.get_by_label("Skeleton").check()
        lines = np.abs(picture(page).astype(int) - (0x00, 0x72, 0xB2)).max(axis=2) < 40
        assert lines.sum() > 200


def test_clips_play_side_by_side_in_time_with_the_speech(
    browser: Browser, shown: MotionClip, tmp_path: Path
) -> None:
    backwards = shown.frames(np.arange(len(shown))[::-1])
    with watched_page(browser, tmp_path.as_uri()) as page:
        opened(page, tmp_path / "page.html", ours=shown, theirs=backwards)
        expect(page.locator(".labels")).to_have_text("ourstheirs")
        page.get_by_label("Speed").select_option("half speed")
        speech = page.locator("audio")
        assert speech.evaluate("audio => audio.playbackRate") == 0.5
        page.get_by_role("button", name="Play").click()
        wait_until(page, lambda: 0 < seconds(page) < shown.duration)
        page.get_by_role("button", name="Pause").click()
        expect(page.get_by_role("button", name="Play")).to_be_visible()
        page.wait_for_timeout(300)
        heard = speech.evaluate("audio => audio.currentTime")
        assert 0 < heard <= shown.duration + 0.1
        assert seconds(page) == pytest.approx(min(heard, shown.duration), abs=0.002)

        left, right = halves(scrub(page, 0.0))
        assert left.any()
        assert shared(left, right) < 0.99
        context = page.locator("canvas").evaluate_handle(
            "canvas => canvas.getContext('webgl2').getExtension('WEBGL_lose_context')"
        )
        context.evaluate("context => context.loseContext()")
        context.evaluate("context => context.restoreContext()")
        wait_until(page, lambda: np.array_equal(halves(picture(page)), (left, right)))


def test_a_paused_figure_is_not_redrawn(
    browser: Browser, shown: MotionClip, tmp_path: Path
) -> None:
    with watched_page(browser, tmp_path.as_uri()) as page:
        page.add_init_script(f"({COUNTED_DRAWINGS})()")
        opened(page, tmp_path / "page.html", ours=shown)
        scrub(page, SECOND)
        drawn = page.evaluate("drawings")
        assert drawn > 0

        picture(page)

        assert page.evaluate("drawings") == drawn


@pytest.mark.parametrize("scheme", SCHEMES)
def test_pages_that_share_viewer_and_avatar_play_without_a_server(
    browser: Browser, shown: MotionClip, tmp_path: Path, scheme: Literal["dark", "light"]
) -> None:
    scenes = [Scene(name="it", clips={"ours": shown}), Scene(name="more", clips={"theirs": shown})]
    write_shared_files(tmp_path, FULL_BODY)
    write_motion_page(tmp_path / "page.html", "Motion", scenes, FULL_BODY, shares=True)
    with watched_page(browser, tmp_path.as_uri()) as page:
        page.emulate_media(color_scheme=scheme)
        page.goto((tmp_path / "page.html").as_uri())
        page.get_by_role("button", name="Play more").click()
        expect(page.locator(".labels")).to_have_text("theirs")
        assert body_in(picture(page)).any()
        photograph(page, f"motion-page-{scheme}", resized=False)
        assert barriers(page) == []


def test_a_browser_without_graphics_shows_a_message(
    browser: Browser, shown: MotionClip, tmp_path: Path
) -> None:
    path = tmp_path / "page.html"
    write_motion_page(path, "Motion", [Scene(name="it", clips={"ours": shown})], FULL_BODY)
    with watched_page(browser, tmp_path.as_uri()) as page:
        page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
        page.goto(path.as_uri())
        expect(page.locator(".problem")).to_contain_text("cannot draw in three dimensions")
