"""A page of Mechanical Turk's that shows a study in a frame, and takes what is handed in."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import parse_qs

from playwright.sync_api import Browser, BrowserContext, Page, Route

from tests.functional.browsing import launched

WORKER = "https://worker.mturk.com"
TASK = f"{WORKER}/projects/1/tasks/1"
NAMES = "workerId=w1&hitId=h1&assignmentId=a1&turkSubmitTo=https%3A%2F%2Fwww.mturk.com"


@contextmanager
def launched_for_frames() -> Iterator[Browser]:
    """Give a browser in which public sites may show what this machine serves."""
    with launched("--disable-features=LocalNetworkAccessChecks") as chromium:
        yield chromium


def frame_of(context: BrowserContext, site: str, address: str) -> Page:
    """Return a page of `site` that shows the study at `address`; it has not been gone to."""
    framing = f'<iframe src="{address}?{NAMES}" width="1300" height="740"></iframe>'
    context.route(f"{site}/**", lambda route: route.fulfill(body=framing, content_type="text/html"))
    return context.new_page()


def handed_in_from(page: Page) -> list[dict[str, list[str]]]:
    """Return a list that fills with what `page` hands in to Mechanical Turk."""
    handed_in: list[dict[str, list[str]]] = []

    def take(route: Route) -> None:
        handed_in.append(parse_qs(route.request.post_data or ""))
        route.fulfill(body="Thank you", content_type="text/plain")

    page.route("https://www.mturk.com/mturk/externalSubmit", take)
    return handed_in
